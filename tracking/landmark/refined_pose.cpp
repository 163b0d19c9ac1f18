#include "tracking/landmark/refined_pose.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tracking/landmark/ippe_pose.hpp"
#include "tracking/landmark/square_pose.hpp"

namespace heartservo::tracking {

namespace {

constexpr double SMALLEST_AREA = 4;  // px^2; seen from the edge, or a speck: no pose to speak of

double angle_between(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return Eigen::AngleAxisd(Eigen::Matrix3d(a.linear().transpose() * b.linear())).angle();
}

}  // namespace

RefinedPose refined_square_pose(const Camera& camera, const Quad& corners, double side_m,
                                const RefinedPoseOptions& options) {
  RefinedPose result;
  for (auto& solution : result.solutions) {
    solution.rms_px = std::numeric_limits<double>::quiet_NaN();
    solution.chi2 = std::numeric_limits<double>::infinity();
  }

  std::array<Eigen::Vector2d, 4> normalised;
  for (int i = 0; i < 4; ++i) normalised[i] = camera.normalise(corners[i]);
  std::array<Eigen::Isometry3d, 2> starts;
  if (!is_convex(corners) || !is_convex(normalised) || area(corners) < SMALLEST_AREA) return result;
  if (!ippe_square_poses(normalised, side_m, starts))
    starts.fill(linear_square_pose(normalised, side_m));

  for (int i = 0; i < 2; ++i) result.solutions[i].T_camera_target = refine_pose(camera, starts[i], side_m, corners);
  // Noise can leave one minimum only, into which the other start slides. Its side is then as IPPE has it: still possible,
  // and how well it fits still tells something.
  auto& second = result.solutions[1].T_camera_target;
  const double apart = angle_between(result.solutions[0].T_camera_target, second);
  if (apart < 0.5 * angle_between(starts[0], starts[1])) second = starts[1];
  for (auto& solution : result.solutions)
    solution.rms_px = reprojection_rms_px(camera, solution.T_camera_target, side_m, corners);
  const auto& [a, b] = result.solutions;
  const double best_rms = std::fmin(a.rms_px, b.rms_px);  // the finite one, if one is
  if (!std::isfinite(best_rms)) return result;

  const double variance = std::max(options.corner_sigma_px * options.corner_sigma_px, 4 * best_rms * best_rms / 2);
  for (auto& solution : result.solutions)
    if (std::isfinite(solution.rms_px)) solution.chi2 = 4 * solution.rms_px * solution.rms_px / variance;
  result.taken = b.chi2 < a.chi2 ? 1 : 0;
  result.preference = std::abs(a.chi2 - b.chi2);
  result.covariance =
      pose_covariance(camera, result.solutions[result.taken].T_camera_target, side_m, options.corner_sigma_px);
  return result;
}

}  // namespace heartservo::tracking
