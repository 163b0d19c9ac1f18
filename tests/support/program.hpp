#pragma once
// Runs a program as a user would: another process, with its own folder, its output caught, and a time limit.
#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/temporary_folder.hpp"

namespace heartservo::test {

struct Outcome {
  int code = -1;           ///< exit code; 128 + signal when a signal ended it
  bool timed_out = false;  ///< and was killed
  std::string out, err;    ///< what it printed

  std::size_t error_lines() const { return static_cast<std::size_t>(std::count(err.begin(), err.end(), '\n')); }
};

/// `meanwhile` is called with the process id every 20 ms while the program runs.
inline Outcome run_process(const std::vector<std::string>& command, const std::filesystem::path& folder,
                           const std::function<void(pid_t)>& meanwhile = {}, double limit_s = 200) {
  const TemporaryFolder caught;
  const std::string out = caught / "out", err = caught / "err", cwd = folder;
  std::vector<char*> argv;
  for (const auto& word : command) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error("cannot fork");
  if (child == 0) {  // only calls that are safe between fork and exec
    const auto redirect = [](const char* file, int stream) {
      const int fd = ::open(file, O_WRONLY | O_CREAT | O_TRUNC, 0644);
      return fd >= 0 && ::dup2(fd, stream) >= 0;
    };
    if (::chdir(cwd.c_str()) == 0 && redirect(out.c_str(), 1) && redirect(err.c_str(), 2))
      ::execvp(argv[0], argv.data());
    ::_exit(127);
  }
  Outcome outcome;
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(limit_s);
  int status = 0;
  while (::waitpid(child, &status, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() > end && !outcome.timed_out) {
      outcome.timed_out = true;
      ::kill(child, SIGKILL);
    }
    if (meanwhile) meanwhile(child);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  outcome.out = read_text(out);
  outcome.err = read_text(err);
  return outcome;
}

}  // namespace heartservo::test
