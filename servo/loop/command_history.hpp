#pragma once
// Commands given and not yet seen: what the robot will do between a frame and the time at which the next command acts.
#include <Eigen/Core>
#include <array>
#include <cstddef>

namespace heartservo::servo {

class CommandHistory {
 public:
  /// Commands must come in the order in which they act.
  void add(double acts_at_s, const Eigen::Vector3d& velocity) {
    entries_[next_ % entries_.size()] = {acts_at_s, velocity};
    ++next_;
  }

  /// The way (m) commanded between two times: the integral of the velocity, each command holding until the next acts.
  Eigen::Vector3d way_between(double from_s, double to_s) const {
    Eigen::Vector3d way = Eigen::Vector3d::Zero();
    double end = to_s;
    for (std::size_t i = 0; i < std::min(next_, entries_.size()) && end > from_s; ++i) {
      const Entry& entry = entries_[(next_ - 1 - i) % entries_.size()];
      const double begin = std::max(from_s, entry.acts_at_s);
      if (begin < end) {
        way += entry.velocity * (end - begin);
        end = begin;
      }
    }
    return way;
  }

 private:
  struct Entry {
    double acts_at_s = 0;
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  };
  std::array<Entry, 256> entries_{};  // 2 s at 125 Hz: longer than any latency a loop can live with
  std::size_t next_ = 0;
};

}  // namespace heartservo::servo
