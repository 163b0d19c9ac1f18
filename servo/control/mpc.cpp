// Model-predictive control (receding horizon): of all velocities over the next periods, the first of those that bring
// the tip nearest to the foreseen path of the goal, through the robot's stated dynamics and within the limits on speed
// and acceleration (Cavusoglu, Rotella, Newman, Choi, Ustin, Sastry: Control algorithms for active relative motion
// cancelling for robotic assisted off-pump coronary artery bypass graft surgery, ICAR 2005; Bebek, Cavusoglu, IEEE T-RO
// 2007). It assumes that the predictor is right over the horizon, the robot linear between its limits, and its stated
// dynamics about right.
#include "servo/control/limited_least_squares.hpp"
#include "servo/control/plant_response.hpp"
#include "servo/control/registry.hpp"

namespace heartservo::servo {

namespace {

class Mpc final : public ControlLaw {
 public:
  explicit Mpc(const ControlSetup& setup)
      : horizon_(setup.options.horizon),
        plant_(setup.robot, setup.period_s),
        problem_(plant_.matrix(horizon_, horizon_), setup.options.smoothing * setup.period_s * setup.period_s,
                 setup.max_speed, setup.max_acceleration * setup.period_s),
        wanted_(horizon_, 3) {}

  Eigen::Vector3d velocity(const ControlState& state) override {
    wanted_ = -plant_.free(state.robot).topRows(horizon_);
    for (int k = 0; k < horizon_; ++k) wanted_.row(k) += state.goal(k + 1).position.transpose();
    if (!wanted_.allFinite() || !state.last_velocity.allFinite()) return Eigen::Vector3d::Constant(NAN);
    return problem_.solve(wanted_, state.last_velocity).row(0);
  }

  int horizon() const override { return horizon_; }

 private:
  int horizon_;
  PlantResponse plant_;
  LimitedLeastSquares problem_;
  Eigen::MatrixXd wanted_;
};

}  // namespace

std::unique_ptr<ControlLaw> make_mpc(const ControlSetup& setup) { return std::make_unique<Mpc>(setup); }

}  // namespace heartservo::servo
