// fork_server FIFO: the program itself, and recording_check, loaded once. To load them costs seconds in an emulated
// machine, more than most of what the tests ask of them, so that each run is a fork of this process. Every line of FIFO
// names a folder with the file `args`: the working folder, the program's name, then its arguments, one a line. The
// run's stdout, stderr, process id and exit code go to the files out, err, pid and code there.
#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "tools/program.hpp"

int recording_check_main(int argc, char** argv);  // recording_check.cpp

namespace {

void write_file(const std::string& file, int number) {
  std::ofstream(file + ".new") << number << "\n";
  std::rename((file + ".new").c_str(), file.c_str());  // never seen half-written
}

[[noreturn]] void run(const std::string& folder) {
  std::ifstream in(folder + "/args");
  std::string cwd;
  std::vector<std::string> words;
  std::getline(in, cwd);
  for (std::string word; std::getline(in, word);) words.push_back(word);
  for (const auto& [name, stream] : {std::pair{"/out", STDOUT_FILENO}, std::pair{"/err", STDERR_FILENO}}) {
    const int fd = ::open((folder + name).c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    ::dup2(fd, stream);
    ::close(fd);
  }
  if (::chdir(cwd.c_str()) != 0 || words.empty()) std::exit(127);
  std::vector<char*> argv;
  for (auto& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  if (words[0] == "recording_check") std::exit(recording_check_main(static_cast<int>(words.size()), argv.data()));
  std::exit(heartservo::tools::run_program({words.begin() + 1, words.end()}));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const int fifo = ::open(argv[1], O_RDWR | O_CLOEXEC);  // also for writing: it does not end with its first writer
  if (fifo < 0) return 2;
  std::map<pid_t, std::string> running;
  std::string waiting;
  while (true) {
    pollfd ready{fifo, POLLIN, 0};
    if (::poll(&ready, 1, 20) > 0) {
      char bytes[4096];
      const ssize_t got = ::read(fifo, bytes, sizeof bytes);
      if (got > 0) waiting.append(bytes, static_cast<std::size_t>(got));
    }
    for (std::size_t end; (end = waiting.find('\n')) != std::string::npos; waiting.erase(0, end + 1)) {
      const std::string folder = waiting.substr(0, end);
      const pid_t child = ::fork();
      if (child == 0) run(folder);
      running[child] = folder;
      write_file(folder + "/pid", child);
    }
    int status = 0;
    for (pid_t child; (child = ::waitpid(-1, &status, WNOHANG)) > 0; running.erase(child))
      write_file(running[child] + "/code", WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status));
  }
}
