#pragma once
// The robot as a row of numbers: where its tip will be at the next kLongestHorizon periods, as a linear function of its
// state and of the velocities commanded, each axis alike (robot_model.hpp without its limits):
//
//   p_k = r + a_k (p - r) + b_k p' + sum_{j < k} h_{k-j} u_j,    k = 1 .. kLongestHorizon.
#include <Eigen/Core>

#include "servo/control/control_law.hpp"

namespace heartservo::servo {

struct PlantResponse {
  using Row = Eigen::Matrix<double, kLongestHorizon, 1>;
  Row a, b;  ///< b in s
  Row h;     ///< s: way of the tip at period k for a velocity of 1 m/s during the first period

  PlantResponse(const ToolRobotData& robot, double period_s);

  /// Where the tip goes if the robot is commanded no more; row k - 1 is p_k.
  Eigen::Matrix<double, kLongestHorizon, 3> free(const RobotState& state) const;

  /// d p_k / d u_j for the first `horizon` periods and `moves` velocities; the last velocity stays.
  Eigen::MatrixXd matrix(int horizon, int moves) const;
};

}  // namespace heartservo::servo
