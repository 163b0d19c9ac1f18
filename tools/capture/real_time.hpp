#pragma once
#include <nlohmann/json.hpp>
#include <string>

namespace heartservo::tools {

/// While it lives, this thread and those that it starts run under SCHED_FIFO and all memory is locked, where the system
/// allows it: it needs root, CAP_SYS_NICE and CAP_IPC_LOCK, or limits.conf entries rtprio and memlock.
class RealTime {
 public:
  /// `wanted` false: nothing is done.
  explicit RealTime(bool wanted);
  ~RealTime();
  RealTime(const RealTime&) = delete;
  RealTime& operator=(const RealTime&) = delete;

  /// {wanted, scheduling: "SCHED_FIFO 50" or why not, memory: "locked" or why not}
  nlohmann::json granted() const;

 private:
  bool wanted_, locked_ = false, scheduled_ = false;
  std::string scheduling_ = "as usual", memory_ = "as usual";
  int old_policy_ = 0, old_priority_ = 0;
};

}  // namespace heartservo::tools
