#include <fcntl.h>
#include <libv4l2.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <time.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>

#include "tracking/frames/v4l2/system_calls.hpp"

namespace heartservo::tracking::v4l2 {

namespace {

constexpr unsigned VIDEO_MAJOR = 81;

int result_of(int value) { return value < 0 ? -errno : value; }

// What C code writes to stderr goes nowhere while this lives.
class NoStderr {
 public:
  NoStderr() : saved_(::fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 3)) {
    std::fflush(stderr);
    const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (saved_ >= 0 && nowhere >= 0) ::dup2(nowhere, STDERR_FILENO);
    if (nowhere >= 0) ::close(nowhere);
  }
  ~NoStderr() {
    std::fflush(stderr);
    if (saved_ >= 0) ::dup2(saved_, STDERR_FILENO), ::close(saved_);
  }
  NoStderr(const NoStderr&) = delete;
  NoStderr& operator=(const NoStderr&) = delete;

 private:
  int saved_;
};

class Libv4l2Calls final : public SystemCalls {
 public:
  // libv4l2 tells stderr about every EAGAIN; errors are ours to say
  Libv4l2Calls() { v4l2_log_file = std::fopen("/dev/null", "we"); }

  int open(const std::string& device) override {
    const auto opened = [&] { return result_of(v4l2_open(device.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC, 0)); };
    struct stat file {};
    if (::stat(device.c_str(), &file) != 0) return -errno;
    if (S_ISCHR(file.st_mode) && major(file.st_rdev) == VIDEO_MAJOR) return opened();
    if (!S_ISREG(file.st_mode)) return -ENOTTY;
    const NoStderr quiet;  // libv4l2 complains of a file that no plugin of it knows
    return opened();
  }
  int close(int fd) override { return result_of(v4l2_close(fd)); }
  int ioctl(int fd, unsigned long request, void* argument) override {
    int result;
    do result = v4l2_ioctl(fd, request, argument);
    while (result < 0 && errno == EINTR);
    return result_of(result);
  }
  void* mmap(int fd, std::size_t length, std::int64_t offset) override {
    void* start = v4l2_mmap(nullptr, length, PROT_READ | PROT_WRITE, MAP_SHARED, fd, offset);
    return start == MAP_FAILED ? nullptr : start;
  }
  int munmap(void* start, std::size_t length) override { return result_of(v4l2_munmap(start, length)); }
  int poll(int fd, int timeout_ms, short& events) override {
    pollfd waiting{fd, POLLIN | POLLPRI, 0};
    const int result = result_of(::poll(&waiting, 1, timeout_ms));
    events = waiting.revents;
    return result;
  }
  bool exists(const std::string& device) override { return ::access(device.c_str(), F_OK) == 0; }
  double now_s() override {
    timespec t{};
    ::clock_gettime(CLOCK_MONOTONIC, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
  }
  void sleep(double seconds) override { ::usleep(static_cast<useconds_t>(1e6 * seconds)); }
};

}  // namespace

SystemCalls& libv4l2_calls() {
  static Libv4l2Calls calls;
  return calls;
}

}  // namespace heartservo::tracking::v4l2
