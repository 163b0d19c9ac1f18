#pragma once
// The system calls of a video device behind one interface, so that tests can script what a driver does.
#include <cstddef>
#include <cstdint>
#include <string>

namespace heartservo::tracking::v4l2 {

/// Every call returns what the system call does, or -errno. None waits longer than it is told to; devices are opened
/// without blocking.
class SystemCalls {
 public:
  virtual ~SystemCalls() = default;
  virtual int open(const std::string& device) = 0;
  virtual int close(int fd) = 0;
  virtual int ioctl(int fd, unsigned long request, void* argument) = 0;
  /// Null on failure.
  virtual void* mmap(int fd, std::size_t length, std::int64_t offset) = 0;
  virtual int munmap(void* start, std::size_t length) = 0;
  /// 0: nothing within `timeout_ms`; else `events` are those that came (POLLIN, POLLPRI, POLLERR, POLLHUP).
  virtual int poll(int fd, int timeout_ms, short& events) = 0;
  /// True while the device's file is there.
  virtual bool exists(const std::string& device) = 0;
  virtual double now_s() = 0;  ///< CLOCK_MONOTONIC, the clock of most drivers' time stamps
  virtual void sleep(double seconds) = 0;
};

/// The real ones, through libv4l2, which converts formats that we do not decode ourselves.
SystemCalls& libv4l2_calls();

}  // namespace heartservo::tracking::v4l2
