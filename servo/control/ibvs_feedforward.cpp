// ibvs on where the robot has been asked to be when the command acts, as if it stood there, against where it must be
// asked for (feed_forward.hpp): the loop adds the velocity of the latter, so that only what was foreseen wrongly is
// left to the gain (Bebek & Cavusoglu, IEEE T-RO 2007). It assumes that the robot's stated dynamics are about right.
//
// The law is that of ibvs.cpp. vpServo makes a dozen matrices anew in every call; with three features of a tip that
// only translates, the interaction matrix can be inverted by hand, and nothing is taken from the heap.
#include <algorithm>
#include <cmath>

#include "servo/control/feed_forward.hpp"
#include "servo/control/registry.hpp"

namespace heartservo::servo {

namespace {

class IbvsFeedForward final : public ControlLaw {
 public:
  IbvsFeedForward(double gain, const ToolRobotData& robot) : gain_(gain), lag_(robot) {}

  // s = (x, y, log Z) of a tip that moves by v: s' = L v, L = 1/Z [1 0 -x; 0 1 -y; 0 0 1], so that s' = -gain (s - s*)
  // is v = -gain L^-1 (s - s*), L^-1 = Z [1 0 x; 0 1 y; 0 0 1].
  Eigen::Vector3d velocity(const ControlState& state) override {
    const Eigen::Vector3d tip = state.robot.reference, goal = asked_goal(state, lag_, 0);
    if (!(tip.z() > 0 && goal.z() > 0) || !tip.allFinite() || !goal.allFinite())
      return Eigen::Vector3d::Constant(NAN);  // the guard refuses it
    const double x = tip.x() / tip.z(), y = tip.y() / tip.z();
    const Eigen::Vector3d error(x - goal.x() / goal.z(), y - goal.y() / goal.z(), std::log(tip.z() / goal.z()));
    // One period cannot undo more than the whole error: a slow camera takes the gain down.
    const double gain = std::min(gain_, 1 / state.period_s);
    return -gain * tip.z() * Eigen::Vector3d(error.x() + x * error.z(), error.y() + y * error.z(), error.z());
  }

  int horizon() const override { return 2; }
  bool wants_feed_forward() const override { return true; }

 private:
  double gain_;
  RobotLag lag_;
};

}  // namespace

std::unique_ptr<ControlLaw> make_ibvs_feedforward(const ControlSetup& setup) {
  return std::make_unique<IbvsFeedForward>(setup.options.gain_feedforward, setup.robot);
}

}  // namespace heartservo::servo
