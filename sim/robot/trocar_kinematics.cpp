#include "sim/robot/trocar_kinematics.hpp"

#include <cmath>

namespace heartservo::sim {

namespace {

Eigen::Vector3d direction(double pan, double tilt) {
  return {std::sin(pan) * std::cos(tilt), -std::sin(tilt), std::cos(pan) * std::cos(tilt)};
}

}  // namespace

TrocarKinematics::TrocarKinematics(const Eigen::Vector3d& tip, const Eigen::Vector3d& axis, double port_distance)
    : port(tip + port_distance * axis.normalized()), length(port_distance) {
  const Eigen::Vector3d e3 = -axis.normalized();
  const Eigen::Vector3d e1 = e3.unitOrthogonal();
  R_base_port << e1, e3.cross(e1), e3;
}

Eigen::Matrix3d TrocarKinematics::R_base_tool(const Eigen::Vector4d& q) const {
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  return R_base_port * (AngleAxisd(q[0], Vector3d::UnitY()) * AngleAxisd(q[1], Vector3d::UnitX()) *
                        AngleAxisd(q[3], Vector3d::UnitZ()))
                           .toRotationMatrix();
}

Eigen::Vector3d TrocarKinematics::tip(const Eigen::Vector4d& q) const {
  return port + (length + q[2]) * (R_base_port * direction(q[0], q[1]));
}

Eigen::Matrix3d TrocarKinematics::jacobian(const Eigen::Vector4d& q) const {
  const double l = length + q[2], sp = std::sin(q[0]), cp = std::cos(q[0]), st = std::sin(q[1]), ct = std::cos(q[1]);
  Eigen::Matrix3d J;
  J << l * cp * ct, -l * sp * st, sp * ct,  //
      0, -l * ct, -st,                      //
      -l * sp * ct, -l * cp * st, cp * ct;
  return R_base_port * J;
}

Eigen::Vector4d TrocarKinematics::joints_of(const Eigen::Vector3d& tip) const {
  const Eigen::Vector3d u = R_base_port.transpose() * (tip - port);
  const double l = u.norm();
  return {std::atan2(u.x(), u.z()), -std::asin(u.y() / l), l - length, 0};
}

}  // namespace heartservo::sim
