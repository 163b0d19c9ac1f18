#include "servo/control/plant_response.hpp"

namespace heartservo::servo {

PlantResponse::PlantResponse(const ToolRobotData& robot, double period_s) {
  constexpr int kSteps = 32;  // a period
  ToolRobotData linear = robot;
  linear.max_speed = linear.max_acceleration = 0;  // not limited
  const RobotModel model(linear);
  RobotState displaced, moving, pushed;
  displaced.tip.x() = 1;
  moving.tip_velocity.x() = 1;
  for (int k = 0; k < kLongestHorizon; ++k) {
    for (int i = 0; i < kSteps; ++i) {
      model.step(displaced, Eigen::Vector3d::Zero(), period_s / kSteps);
      model.step(moving, Eigen::Vector3d::Zero(), period_s / kSteps);
      model.step(pushed, Eigen::Vector3d(k == 0 ? 1 : 0, 0, 0), period_s / kSteps);
    }
    a[k] = displaced.tip.x();
    b[k] = moving.tip.x();
    h[k] = pushed.tip.x();
  }
}

Eigen::Matrix<double, kLongestHorizon, 3> PlantResponse::free(const RobotState& s) const {
  return Row::Ones() * s.reference.transpose() + a * (s.tip - s.reference).transpose() + b * s.tip_velocity.transpose();
}

Eigen::MatrixXd PlantResponse::matrix(int horizon, int moves) const {
  Eigen::MatrixXd G = Eigen::MatrixXd::Zero(horizon, moves);
  for (int k = 0; k < horizon; ++k)
    for (int j = 0; j <= k; ++j) G(k, std::min(j, moves - 1)) += h[k - j];
  return G;
}

}  // namespace heartservo::servo
