#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace heartservo::servo {
struct LoopRecord;
}

namespace heartservo::tools {

/// How a loop on a camera keeps time.
class LiveTiming {
 public:
  /// Allocates nothing for the first `rows` frames.
  LiveTiming(double frame_rate_hz, std::size_t rows);

  /// `now_s`: when the step was done, on any clock.
  void add(const servo::LoopRecord& record, double now_s);

  /// {age_ms, glass_to_command_ms: {p50, p99, max}; period_ms: {min, p50, p99, max}; overruns: steps whose computing
  /// took longer than a frame; skipped_frames}
  nlohmann::json summary() const;

 private:
  double period_s_;
  std::vector<double> ages_ms_, latencies_ms_, periods_ms_;
  double last_s_ = 0;
  bool any_ = false;
  std::size_t overruns_ = 0, skipped_ = 0;
};

/// The table for the terminal.
std::string live_text(const nlohmann::json& live);

}  // namespace heartservo::tools
