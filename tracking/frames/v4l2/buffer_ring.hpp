#pragma once
// The driver's buffers in our memory, and the stream that fills them.
#include <cstdint>
#include <span>
#include <vector>

#include "tracking/frames/v4l2/system_calls.hpp"

namespace heartservo::tracking::v4l2 {

/// A buffer as the driver gave it back; its bytes stay until give_back().
struct Filled {
  std::uint32_t index = 0, bytes_used = 0, flags = 0, sequence = 0, field = 0;
  double time_s = 0;  ///< as the driver stamped it
  std::span<const std::uint8_t> bytes;
};

class BufferRing {
 public:
  BufferRing(SystemCalls& calls, int fd) : calls_(calls), fd_(fd) {}
  ~BufferRing() { stop(); }
  BufferRing(const BufferRing&) = delete;
  BufferRing& operator=(const BufferRing&) = delete;

  /// Asks for buffers, maps them, hands them to the driver and starts the stream. 0 or -errno; then nothing is left.
  int start(int count);
  /// Stops the stream and gives the buffers up; without effect where it does not run.
  void stop();
  int size() const { return static_cast<int>(mapped_.size()); }

  /// 0, or -errno (-EAGAIN: none is ready). Does not wait.
  int take(Filled& filled);
  int give_back(const Filled& filled);

 private:
  int map(int count);

  SystemCalls& calls_;
  int fd_;
  std::vector<std::span<std::uint8_t>> mapped_;
};

}  // namespace heartservo::tracking::v4l2
