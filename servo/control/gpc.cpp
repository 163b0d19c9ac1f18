// Generalised predictive control with a repetitive disturbance (Clarke, Mohtadi, Tuffs, Automatica 1987; Ginhoux,
// Gangloff, de Mathelin, Soler, Arenas Sanchez, Marescaux: Active filtering of physiological motion in robotized
// surgery using predictive control, IEEE T-RO 2005). The goal's motion is the disturbance; it is foreseen from its own
// last period (repeated_path.hpp) and not by the loop's predictor, which only serves until a period is known. Then
//
//   minimise  sum_{k=1}^{N} |p_k - w_k|^2 + smoothing T^2 sum_{j < moves} |u_j - u_{j-1}|^2
//
// without limits, in closed form. It assumes a heart and a breath that repeat from one beat to the next, and a robot
// as stated. Unlike the other laws it remembers: call it once a frame.
#include <Eigen/LU>
#include <algorithm>

#include "servo/control/plant_response.hpp"
#include "servo/control/registry.hpp"
#include "servo/control/repeated_path.hpp"

namespace heartservo::servo {

namespace {

class Gpc final : public ControlLaw {
 public:
  explicit Gpc(const ControlSetup& setup)
      : horizon_(setup.options.horizon),
        smooth_(setup.options.smoothing * setup.period_s * setup.period_s),
        plant_(setup.robot, setup.period_s),
        path_(setup.period_s),
        wanted_(horizon_, 3) {
    const int moves = std::min(setup.options.moves, horizon_);
    const Eigen::MatrixXd G = plant_.matrix(horizon_, moves);
    Eigen::MatrixXd S = Eigen::MatrixXd::Identity(moves, moves);
    for (int j = 1; j < moves; ++j) S(j, j - 1) = -1;
    const Eigen::MatrixXd inverse = (G.transpose() * G + smooth_ * S.transpose() * S).inverse();
    gains_ = inverse.row(0) * G.transpose();
    last_gain_ = inverse(0, 0) * smooth_;
  }

  Eigen::Vector3d velocity(const ControlState& state) override {
    path_.add(state.goal_now);
    wanted_ = -plant_.free(state.robot).topRows(horizon_);
    for (int k = 0; k < horizon_; ++k) {
      const double ahead = state.acts_at_s + (k + 1) * state.period_s - state.time_s;
      wanted_.row(k) +=
          (path_.known() ? Eigen::Vector3d(path_.at(ahead) + state.shift(k + 1)) : state.goal(k + 1).position)
              .transpose();
    }
    return (gains_.lazyProduct(wanted_)).transpose() + last_gain_ * state.last_velocity;
  }

  int horizon() const override { return horizon_; }

 private:
  int horizon_;
  double smooth_, last_gain_ = 0;
  PlantResponse plant_;
  RepeatedPath path_;
  Eigen::RowVectorXd gains_;
  Eigen::MatrixXd wanted_;
};

}  // namespace

std::unique_ptr<ControlLaw> make_gpc(const ControlSetup& setup) { return std::make_unique<Gpc>(setup); }

}  // namespace heartservo::servo
