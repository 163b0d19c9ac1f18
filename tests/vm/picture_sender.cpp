// picture_sender FILE BYTES TIMES BEGIN DONE END: writes the pictures of FILE, BYTES each, to stdout, for v4l2-ctl to
// send them: the first again and again until the file BEGIN is there, then each TIMES times, then the last, making the
// file DONE, until the file END is there.
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>

namespace {

bool there(const char* file) { return ::access(file, F_OK) == 0; }

bool put(const char* bytes, std::size_t count) {
  while (count > 0) {
    const ssize_t done = ::write(STDOUT_FILENO, bytes, count);
    if (done <= 0) return false;
    bytes += done;
    count -= static_cast<std::size_t>(done);
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 7) return 2;
  std::ifstream in(argv[1], std::ios::binary);
  const std::string all{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  const std::size_t bytes = std::strtoul(argv[2], nullptr, 10), count = bytes > 0 ? all.size() / bytes : 0;
  const int times = std::atoi(argv[3]);
  if (count == 0 || times < 1) return 2;
  std::signal(SIGPIPE, SIG_IGN);
  while (!there(argv[4]))
    if (!put(all.data(), bytes)) return 1;
  for (std::size_t i = 0; i < count; ++i)
    for (int k = 0; k < times; ++k)
      if (!put(all.data() + i * bytes, bytes)) return 1;
  for (int k = 0; !there(argv[6]); ++k) {
    if (k == 15) std::ofstream(argv[5]) << "done\n";  // what waits in v4l2-ctl and the driver is out by then
    if (!put(all.data() + (count - 1) * bytes, bytes)) return 1;
  }
}
