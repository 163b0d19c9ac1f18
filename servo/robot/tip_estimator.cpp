#include "servo/robot/tip_estimator.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>

namespace heartservo::servo {

namespace {

constexpr double kOffsetPrior_m = 0.02;  // nothing is known of the offset until the marker was seen

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& a) {
  Eigen::Matrix3d m;
  m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return m;
}

}  // namespace

TipEstimator::TipEstimator(const TipOptions& options, const ToolRobotData& robot,
                           const Eigen::Vector3d& marker_to_tip_camera)
    : options_(options), robot_(robot), marker_to_tip_(marker_to_tip_camera) {
  P_.diagonal().head<3>().setConstant(kOffsetPrior_m * kOffsetPrior_m);
  P_.diagonal().tail<3>().setConstant(options.rotation_prior * options.rotation_prior);
}

void TipEstimator::learn(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance, const Eigen::Vector3d& arm,
                         double dt) {
  P_.diagonal().head<3>().array() += options_.offset_drift * options_.offset_drift * dt;
  if (options_.rotation_prior > 0)
    P_.diagonal().tail<3>().array() += options_.rotation_drift * options_.rotation_drift * dt;
  Eigen::Matrix<double, 3, 6> H;
  H << Eigen::Matrix3d::Identity(), -cross_matrix(arm);  // o + theta x arm
  Eigen::Matrix3d R = covariance.allFinite() ? covariance : Eigen::Matrix3d::Zero().eval();
  R.diagonal().array() += options_.smallest_sigma_m * options_.smallest_sigma_m;
  const Eigen::Matrix3d S = H * P_ * H.transpose() + R;
  const Eigen::Matrix<double, 6, 3> K = P_ * H.transpose() * S.inverse();
  x_ += K * (error - H * x_);
  P_ -= (K * H * P_).eval();
  P_ = (0.5 * (P_ + P_.transpose())).eval();
}

Eigen::Vector3d TipEstimator::estimate(const ToolState& encoders, const tracking::TargetState& marker) {
  const Eigen::Vector3d by_encoders = robot_.R_camera_base * encoders.tip + robot_.t_camera_base;
  if (!started_) start_ = by_encoders, last_time_s_ = encoders.time_s, started_ = true;
  const Eigen::Vector3d arm = by_encoders - start_;
  if (options_.use_marker && marker.state == tracking::TrackState::OK) {
    const Eigen::Matrix3d turned = robot_.R_camera_base * encoders.R_start_tool * robot_.R_camera_base.transpose();
    const Eigen::Vector3d by_marker = marker.T_camera_target.translation() + turned * marker_to_tip_;
    learn(by_marker - by_encoders, marker.position_covariance, arm, std::max(0.0, encoders.time_s - last_time_s_));
    last_time_s_ = encoders.time_s;
  }
  offset_ = x_.head<3>() + x_.tail<3>().cross(arm);
  return by_encoders + offset_;
}

Eigen::Matrix3d TipEstimator::R_camera_base() const {
  const Eigen::Vector3d theta = x_.tail<3>();
  const double angle = theta.norm();
  if (angle < 1e-12) return robot_.R_camera_base;
  return Eigen::AngleAxisd(angle, theta / angle) * robot_.R_camera_base;
}

}  // namespace heartservo::servo
