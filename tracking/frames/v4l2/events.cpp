#include "tracking/frames/v4l2/events.hpp"

#include <iterator>

namespace heartservo::tracking::v4l2 {

const char* name_of(Event event) {
  static constexpr const char* NAMES[] = {"bad_buffer",         "bad_picture",    "sequence_gap",  "sequence_restart",
                                          "time_jump",          "stream_error",   "unplugged",     "disconnected",
                                          "no_signal",          "no_lock",        "out_of_range",  "signal_back",
                                          "resolution_changed", "frozen_picture", "picture_moves", "starved",
                                          "restarted",          "reopened",       "recovered",     "gave_up"};
  static_assert(std::size(NAMES) == static_cast<std::size_t>(Event::GAVE_UP) + 1);
  return NAMES[static_cast<std::size_t>(event)];
}

void EventLog::add(double time_s, Event event, std::string detail) {
  const std::lock_guard lock(mutex_);
  ++counts_[static_cast<std::size_t>(event)];
  if (records_.size() == kept_) records_.erase(records_.begin());
  records_.push_back({time_s, event, std::move(detail)});
}

std::vector<EventRecord> EventLog::records() const {
  const std::lock_guard lock(mutex_);
  return records_;
}

std::uint64_t EventLog::count(Event event) const {
  const std::lock_guard lock(mutex_);
  return counts_[static_cast<std::size_t>(event)];
}

std::map<std::string, std::uint64_t> EventLog::counts() const {
  const std::lock_guard lock(mutex_);
  std::map<std::string, std::uint64_t> result;
  for (std::size_t i = 0; i < counts_.size(); ++i)
    if (counts_[i] > 0) result[name_of(static_cast<Event>(i))] = counts_[i];
  return result;
}

}  // namespace heartservo::tracking::v4l2
