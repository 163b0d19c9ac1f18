// heartservo: one program, one file per command.
#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <opencv2/core/utils/logger.hpp>

#include "tools/program.hpp"

namespace {

// A stream that the caller closed would give its number to the next file opened, and our lines would land in there.
// A placeholder that cannot be used keeps the number, and writing fails as it should.
void occupy_closed_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(stream, F_GETFD) < 0 && errno == EBADF)
      ::open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
}

}  // namespace

int main(int argc, char** argv) {
  occupy_closed_streams();
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);  // errors are ours to say, in one line
  return heartservo::tools::run_program({argv + 1, argv + argc});
}
