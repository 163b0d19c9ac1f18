// Image-based visual servoing with a fixed endoscope (eye-to-hand), through ViSP: the features x, y and log(Z/Z*) of
// the tool tip are driven to those of the goal (Chaumette & Hutchinson, IEEE RAM 2006; Nakamura et al., ICRA 2001).
// It uses the tip as it is seen now and assumes nothing of the robot.
#include <visp3/core/vpException.h>
#include <visp3/visual_features/vpFeatureDepth.h>
#include <visp3/visual_features/vpFeaturePoint.h>
#include <visp3/vs/vpServo.h>

#include <algorithm>
#include <cmath>

#include "servo/control/registry.hpp"

namespace heartservo::servo {

namespace {

class Ibvs final : public ControlLaw {
 public:
  explicit Ibvs(double gain) : gain_(gain) {
    servo_.setServo(vpServo::EYETOHAND_L_cVe_eJe);
    servo_.setInteractionMatrixType(vpServo::CURRENT);
    point_.buildFrom(0, 0, 1);
    point_goal_.buildFrom(0, 0, 1);
    depth_.buildFrom(0, 0, 1, 0);
    depth_goal_.buildFrom(0, 0, 1, 0);
    servo_.addFeature(point_, point_goal_);
    servo_.addFeature(depth_, depth_goal_);
    servo_.set_cVe(vpVelocityTwistMatrix());  // velocities are commanded along the camera's axes
    vpMatrix eJe(6, 3);                       // the tool only translates
    for (unsigned i = 0; i < 3; ++i) eJe[i][i] = 1;
    servo_.set_eJe(eJe);
  }
  ~Ibvs() override { servo_.kill(); }

  Eigen::Vector3d velocity(const ControlState& state) override {
    const Eigen::Vector3d &tip = state.tip_now, &goal = state.goal_then.position;
    if (!(tip.z() > 0 && goal.z() > 0) || !tip.allFinite() || !goal.allFinite())
      return Eigen::Vector3d::Constant(NAN);  // the guard refuses it
    const double x = tip.x() / tip.z(), y = tip.y() / tip.z();
    point_.buildFrom(x, y, tip.z());
    depth_.buildFrom(x, y, tip.z(), std::log(tip.z() / goal.z()));
    point_goal_.buildFrom(goal.x() / goal.z(), goal.y() / goal.z(), goal.z());
    // One period cannot undo more than the whole error: a slow camera takes the gain down.
    servo_.setLambda(std::min(gain_, 1 / state.period_s));
    try {
      const vpColVector v = servo_.computeControlLaw();
      return {v[0], v[1], v[2]};
    } catch (const vpException&) {
      return Eigen::Vector3d::Constant(NAN);
    }
  }

  int horizon() const override { return 0; }

 private:
  double gain_;
  vpServo servo_;
  vpFeaturePoint point_, point_goal_;
  vpFeatureDepth depth_, depth_goal_;
};

}  // namespace

std::unique_ptr<ControlLaw> make_ibvs(const ControlSetup& setup) { return std::make_unique<Ibvs>(setup.options.gain); }

}  // namespace heartservo::servo
