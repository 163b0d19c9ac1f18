#pragma once
// A straight tool that pivots about a port: joints pan, tilt (rad), insertion (m) and roll (rad), all 0 at the start.
#include <Eigen/Geometry>

namespace heartservo::sim {

struct TrocarKinematics {
  Eigen::Vector3d port;        ///< base frame, m
  Eigen::Matrix3d R_base_port; ///< third axis: from the port to the tip at the start
  double length;               ///< from port to tip at the start, m

  /// For a shaft that leaves the tip along `axis` (unit length, base frame) and goes through a port `length` away.
  TrocarKinematics(const Eigen::Vector3d& tip, const Eigen::Vector3d& axis, double port_distance);

  Eigen::Matrix3d R_base_tool(const Eigen::Vector4d& joints) const;
  Eigen::Vector3d tip(const Eigen::Vector4d& joints) const;
  /// d tip / d (pan, tilt, insertion); roll does not move the tip.
  Eigen::Matrix3d jacobian(const Eigen::Vector4d& joints) const;
  /// Pan, tilt and insertion that bring the tip to a place (m, base frame), with no roll.
  Eigen::Vector4d joints_of(const Eigen::Vector3d& tip) const;
};

}  // namespace heartservo::sim
