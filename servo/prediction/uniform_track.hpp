#pragma once
// The last seconds of a motion, resampled at equal steps by straight lines between samples. A gap longer than kGap_s
// starts it anew.
#include <Eigen/Core>
#include <cmath>

namespace heartservo::servo {

class UniformTrack {
 public:
  using Axes = Eigen::Matrix<double, 1, 3>;
  static constexpr double kGap_s = 1.0;

  explicit UniformTrack(int capacity) : p_(capacity, 3) {}

  void restart(double step_s) {
    step_s_ = step_s;
    count_ = 0;
    seen_ = false;
  }

  /// `time_s` later than the last one. Returns how many steps were added.
  int add(double time_s, const Axes& position) {
    if (seen_ && time_s - last_s_ > kGap_s) restart(step_s_);
    int added = 0;
    if (!seen_) {
      first_s_ = time_s;
      push(position);
      added = 1;
    } else {
      for (double t = end_s() + step_s_; t <= time_s + 1e-9; t = end_s() + step_s_, ++added) {
        const double share = (t - last_s_) / (time_s - last_s_);
        push((last_ + share * (position - last_)).eval());
      }
    }
    seen_ = true;
    last_s_ = time_s;
    last_ = position;
    return added;
  }

  double step_s() const { return step_s_; }
  /// Of the newest step.
  double end_s() const { return first_s_ + step_s_ * static_cast<double>(count_ - 1); }
  int size() const { return static_cast<int>(std::min<long>(count_, p_.rows())); }
  /// `back` steps before the newest.
  Axes at(int back) const { return p_.row((count_ - 1 - back) % p_.rows()); }

 private:
  void push(const Axes& position) { p_.row(count_++ % p_.rows()) = position; }

  Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> p_;
  double step_s_ = 0.016, first_s_ = 0, last_s_ = 0;
  Axes last_ = Axes::Zero();
  long count_ = 0;
  bool seen_ = false;
};

}  // namespace heartservo::servo
