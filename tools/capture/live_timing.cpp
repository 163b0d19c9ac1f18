#include "tools/capture/live_timing.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "servo/loop/loop_record.hpp"
#include "servo/loop/score.hpp"

namespace heartservo::tools {

namespace {

using nlohmann::json;

json percentiles(const std::vector<double>& values) {
  if (values.empty()) return nullptr;
  return {{"min", servo::percentile(values, 0)},
          {"p50", servo::percentile(values, 50)},
          {"p99", servo::percentile(values, 99)},
          {"max", servo::percentile(values, 100)}};
}

}  // namespace

LiveTiming::LiveTiming(double frame_rate_hz, std::size_t rows) : period_s_(1 / frame_rate_hz) {
  for (auto* values : {&ages_ms_, &latencies_ms_, &periods_ms_}) values->reserve(rows);
}

void LiveTiming::add(const servo::LoopRecord& record, double now_s) {
  if (record.frame.capture) {  // a frame that was made up has no glass
    ages_ms_.push_back(1e3 * record.age_s);
    latencies_ms_.push_back(1e3 * record.glass_to_command_s);
    skipped_ += record.frame.capture->skipped;
  }
  if (any_) periods_ms_.push_back(1e3 * (now_s - last_s_));
  overruns_ += record.chain_ms > 1e3 * period_s_;
  last_s_ = now_s;
  any_ = true;
}

json LiveTiming::summary() const {
  return {{"age_ms", percentiles(ages_ms_)},
          {"glass_to_command_ms", percentiles(latencies_ms_)},
          {"period_ms", percentiles(periods_ms_)},
          {"nominal_period_ms", 1e3 * period_s_},
          {"overruns", overruns_},
          {"skipped_frames", skipped_}};
}

std::string live_text(const json& live) {
  std::string text = fmt::format("{:<22}{:>10}{:>10}{:>10}{:>10}\n", "time, ms", "min", "median", "p99", "max");
  const auto row = [&](const char* name, const json& values) {
    if (values.is_null()) return;
    text += fmt::format("{:<22}{:>10.2f}{:>10.2f}{:>10.2f}{:>10.2f}\n", name, values["min"].get<double>(),
                        values["p50"].get<double>(), values["p99"].get<double>(), values["max"].get<double>());
  };
  row("period", live["period_ms"]);
  row("age at use", live["age_ms"]);
  row("glass to command", live["glass_to_command_ms"]);
  const json& real_time = live["real_time"];
  return text +
         fmt::format(
             "nominal period {:.2f} ms, {} overruns, {} frames skipped for newer ones; scheduling {}, memory {}\n",
             live["nominal_period_ms"].get<double>(), live["overruns"].get<int>(), live["skipped_frames"].get<int>(),
             real_time["scheduling"].get<std::string>(), real_time["memory"].get<std::string>());
}

}  // namespace heartservo::tools
