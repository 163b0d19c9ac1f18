#include "tracking/frames/v4l2/capture_statistics.hpp"

#include <algorithm>
#include <cmath>

namespace heartservo::tracking::v4l2 {

namespace {

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double deviation(const std::vector<double>& values) {
  if (values.size() < 2) return 0;
  double sum = 0, squares = 0;
  for (const double v : values) sum += v;
  const double mean = sum / static_cast<double>(values.size());
  for (const double v : values) squares += (v - mean) * (v - mean);
  return std::sqrt(squares / static_cast<double>(values.size()));
}

}  // namespace

CaptureStatistics::CaptureStatistics() {
  for (auto* values : {&intervals_, &transfers_, &decodes_}) values->reserve(KEPT);
}

void CaptureStatistics::keep(std::vector<double>& values, double value) {
  if (values.size() < KEPT)
    values.push_back(value);
  else
    values[frames_ % KEPT] = value;
}

void CaptureStatistics::frame(double time_s, double dequeued_s, double decoded_s, std::uint32_t steps,
                              std::uint32_t missing, std::uint32_t skipped) {
  const std::lock_guard lock(mutex_);
  if (any_ && steps > 0) keep(intervals_, (time_s - last_s_) / steps);
  keep(transfers_, dequeued_s - time_s);
  keep(decodes_, decoded_s - dequeued_s);
  ++frames_;
  missing_ += missing;
  skipped_ += skipped;
  last_s_ = time_s;
  any_ = true;
}

void CaptureStatistics::bad() {
  const std::lock_guard lock(mutex_);
  ++bad_;
}

void CaptureStatistics::interrupted() {
  const std::lock_guard lock(mutex_);
  any_ = false;
}

void CaptureStatistics::write(CaptureReport& report) const {
  const std::lock_guard lock(mutex_);
  const double interval = median(intervals_);
  report.measured_rate_hz = interval > 0 ? 1 / interval : 0;
  report.jitter_ms = 1e3 * deviation(intervals_);
  report.transfer_ms = 1e3 * median(transfers_);
  report.decode_ms = 1e3 * median(decodes_);
  report.frames = frames_;
  report.missing = missing_;
  report.skipped = skipped_;
  report.bad = bad_;
}

}  // namespace heartservo::tracking::v4l2
