#pragma once
#include <cstdint>
#include <mutex>
#include <vector>

#include "tracking/frames/live_source.hpp"

namespace heartservo::tracking::v4l2 {

/// Rate, jitter and counts of what came. May be read from another thread.
class CaptureStatistics {
 public:
  CaptureStatistics();
  /// A frame delivered: its time stamp, the times when it was taken and decoded, and how many came or should have come
  /// since the last delivered one, itself included.
  void frame(double time_s, double dequeued_s, double decoded_s, std::uint32_t steps, std::uint32_t missing,
             std::uint32_t skipped);
  void bad();
  /// The next interval spans an outage and does not count.
  void interrupted();
  void write(CaptureReport& report) const;

 private:
  static constexpr std::size_t KEPT = 4096;  // latest frames that medians are made from
  void keep(std::vector<double>& values, double value);

  mutable std::mutex mutex_;
  std::vector<double> intervals_, transfers_, decodes_;
  std::uint64_t frames_ = 0, missing_ = 0, skipped_ = 0, bad_ = 0;
  double last_s_ = 0;
  bool any_ = false;
};

}  // namespace heartservo::tracking::v4l2
