#include "tracking/landmark/refined_pose.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tracking/landmark/ippe_pose.hpp"
#include "tracking/landmark/square_pose.hpp"

namespace heartservo::tracking {

namespace {

constexpr double SMALLEST_AREA = 4;  // px^2; seen from the edge, or a speck: no pose to speak of

double angle_between(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return Eigen::AngleAxisd(Eigen::Matrix3d(a.transpose() * b)).angle();
}

double cost(const PoseSolution& solution, double variance_px2, const RefinedPoseOptions& options,
            const std::optional<Eigen::Isometry3d>& predicted) {
  if (!std::isfinite(solution.rms_px)) return std::numeric_limits<double>::infinity();
  const double fit = 4 * solution.rms_px * solution.rms_px / variance_px2;
  if (!predicted) return fit;
  const auto& T = solution.T_camera_target;
  const double angle = angle_between(T.linear(), predicted->linear()) / options.predicted_angle_sigma;
  const double distance = (T.translation() - predicted->translation()).norm() / options.predicted_position_sigma;
  return fit + angle * angle + distance * distance;
}

}  // namespace

RefinedPose refined_square_pose(const Camera& camera, const Quad& corners, double side_m,
                                const RefinedPoseOptions& options, const std::optional<Eigen::Isometry3d>& predicted) {
  RefinedPose result;
  for (auto& solution : result.solutions) solution.rms_px = std::numeric_limits<double>::quiet_NaN();

  std::array<Eigen::Vector2d, 4> normalised;
  for (int i = 0; i < 4; ++i) normalised[i] = camera.normalise(corners[i]);
  std::array<Eigen::Isometry3d, 2> starts;
  if (!is_convex(corners) || !is_convex(normalised) || area(corners) < SMALLEST_AREA) return result;
  if (!ippe_square_poses(normalised, side_m, starts))  // OpenCV has none for a square that faces the camera exactly
    starts.fill(linear_square_pose(normalised, side_m));

  for (int i = 0; i < 2; ++i) {
    auto& solution = result.solutions[i];
    solution.T_camera_target = refine_pose(camera, starts[i], side_m, corners);
    solution.rms_px = reprojection_rms_px(camera, solution.T_camera_target, side_m, corners);
  }
  const auto& [a, b] = result.solutions;
  const double best_rms = std::fmin(a.rms_px, b.rms_px);  // the finite one, if one is
  if (!std::isfinite(best_rms)) return result;

  // A residual far above the stated sigma means that the stated sigma is wrong, not that a solution is certain.
  const double variance = std::max(options.corner_sigma_px * options.corner_sigma_px, 4 * best_rms * best_rms / 2);
  const double cost_a = cost(a, variance, options, predicted), cost_b = cost(b, variance, options, predicted);
  result.taken = cost_b < cost_a ? 1 : 0;
  result.preference = std::abs(cost_a - cost_b);
  result.covariance =
      pose_covariance(camera, result.solutions[result.taken].T_camera_target, side_m, options.corner_sigma_px);
  return result;
}

}  // namespace heartservo::tracking
