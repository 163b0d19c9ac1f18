#include "tools/sweep/caught.hpp"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "tracking/settings/errors.hpp"

namespace heartservo::tools {

namespace {

// A file without a name, so that neither stream can fill up while the other is read.
struct Catch {
  int file = ::memfd_create("caught", MFD_CLOEXEC);
  Catch() = default;
  Catch(const Catch&) = delete;
  Catch& operator=(const Catch&) = delete;
  ~Catch() { ::close(file); }

  std::string text(const std::string& between_lines) const {
    std::string all;
    char buffer[4096];
    ::lseek(file, 0, SEEK_SET);
    for (ssize_t n; (n = ::read(file, buffer, sizeof(buffer))) > 0;) all.append(buffer, static_cast<std::size_t>(n));
    while (!all.empty() && all.back() == '\n') all.pop_back();
    for (std::size_t at = 0; (at = all.find('\n', at)) != std::string::npos; at += between_lines.size())
      all.replace(at, 1, between_lines);
    return all;
  }
};

}  // namespace

Caught ask_program(const std::vector<std::string>& command) {
  const Catch out, err;
  if (out.file < 0 || err.file < 0) throw ConfigError(fmt::format("no memory for an answer: {}", std::strerror(errno)));
  std::vector<char*> argv;
  for (const auto& word : command) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, out.file, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, err.file, STDERR_FILENO);
  pid_t pid = 0;
  const int error = ::posix_spawnp(&pid, argv[0], &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error == ENOENT) return {127, "", ""};
  if (error != 0) throw ConfigError(fmt::format("{} cannot be run: {}", command[0], std::strerror(error)));
  int status = 0;
  while (::waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, out.text("\n"), err.text("; ")};
}

}  // namespace heartservo::tools
