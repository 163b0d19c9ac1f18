#include "tracking/landmark/landmark_estimator.hpp"

#include <fmt/format.h>

#include <cmath>

#include "tracking/landmark/square_pose.hpp"
#include "tracking/landmark/visp_pose.hpp"
#include "tracking/settings/errors.hpp"
#include "tracking/settings/yaml_reader.hpp"

namespace heartservo::tracking {

namespace {

std::array<Eigen::Vector2d, 4> normalise(const Camera& camera, const Quad& corners) {
  std::array<Eigen::Vector2d, 4> result;
  for (int i = 0; i < 4; ++i) result[i] = camera.normalise(corners[i]);
  return result;
}

}  // namespace

LandmarkEstimator::LandmarkEstimator(const Camera& camera, double side_m, const std::string& method,
                                     double corner_sigma_px)
    : camera_(camera), side_m_(side_m), corner_sigma_px_(corner_sigma_px) {
  if (method == "refined")
    method_ = Method::REFINED;
  else if (method == "linear")
    method_ = Method::LINEAR;
  else if (method == "visp")
    method_ = Method::VISP;
  else
    throw ConfigError(fmt::format("pose method '{}' is not known{}; choose one of refined, linear, visp", method,
                                  did_you_mean(method, {"refined", "linear", "visp"})));
  if (!(side_m > 0) || !std::isfinite(side_m))
    throw ConfigError(fmt::format("landmark side is {} m; must be positive", side_m));
  if (!(corner_sigma_px > 0) || !std::isfinite(corner_sigma_px))
    throw ConfigError(fmt::format("corner sigma is {} px; must be positive", corner_sigma_px));
}

TargetState LandmarkEstimator::estimate(const Track& track) {
  TargetState state;
  state.time_s = track.time_s;
  state.sequence = track.sequence;
  state.quality = track.quality;
  if (track.state == TrackState::LOST || !is_convex(track.corners) || !solve(track, state)) return state;
  if (!state.T_camera_target.matrix().allFinite() || !(state.T_camera_target.translation().z() > 0) ||
      !state.position_covariance.allFinite()) {
    state.T_camera_target.setIdentity();
    state.position_covariance.setZero();
    return state;
  }
  state.state = track.state;
  return state;
}

bool LandmarkEstimator::solve(const Track& track, TargetState& state) {
  if (method_ == Method::REFINED) {
    RefinedPoseOptions options;
    options.corner_sigma_px = corner_sigma_px_;
    refined_ = refined_square_pose(camera_, track.corners, side_m_, options);
    if (refined_.taken < 0) return false;
    choose_side(track);
    state.T_camera_target = refined_.solutions[refined_.taken].T_camera_target;
    state.position_covariance = refined_.covariance.topLeftCorner<3, 3>();
    return true;
  }
  const auto normalised = normalise(camera_, track.corners);
  if (!is_convex(normalised)) return false;
  if (method_ == Method::LINEAR) {
    state.T_camera_target = linear_square_pose(normalised, side_m_);
    state.position_covariance = linear_covariance(track.corners);
    return true;
  }
  const auto pose = visp_square_pose(normalised, side_m_);
  if (!pose) return false;
  state.T_camera_target = *pose;
  state.position_covariance = pose_covariance(camera_, *pose, side_m_, corner_sigma_px_).topLeftCorner<3, 3>();
  return true;
}

// Eq. 6-8 is no minimum of anything, so its covariance is its own derivative with respect to the corners, squared.
Eigen::Matrix3d LandmarkEstimator::linear_covariance(const Quad& corners) const {
  constexpr double STEP = 1e-3;  // px
  Eigen::Matrix<double, 3, 8> J;
  for (int i = 0; i < 8; ++i) {
    Quad up = corners, down = corners;
    up[i / 2](i % 2) += STEP;
    down[i / 2](i % 2) -= STEP;
    J.col(i) = (linear_square_pose(normalise(camera_, up), side_m_).translation() -
                linear_square_pose(normalise(camera_, down), side_m_).translation()) /
               (2 * STEP);
  }
  return J * J.transpose() * (corner_sigma_px_ * corner_sigma_px_);
}

void LandmarkEstimator::choose_side(const Track& track) {
  const auto& [a, b] = refined_.solutions;
  const SideFilter::Rotations rotations{a.T_camera_target.linear(), b.T_camera_target.linear()};
  const std::array<double, 2> chi2{a.chi2, b.chi2};
  // What an UNCERTAIN frame shows is judged by the frames before, and does not count for those to come.
  const double sigma = std::sqrt(refined_.covariance.diagonal().tail<3>().maxCoeff());
  const auto log_p = track.state == TrackState::OK
                         ? sides_.keep(track.time_s, rotations, chi2, sigma)
                         : sides_.log_probabilities(track.time_s, rotations, chi2, sigma);
  const int taken = log_p[1] > log_p[0] ? 1 : 0;
  refined_.preference = 2 * std::abs(log_p[0] - log_p[1]);
  if (taken == refined_.taken) return;
  refined_.taken = taken;
  refined_.covariance = pose_covariance(camera_, refined_.solutions[taken].T_camera_target, side_m_, corner_sigma_px_);
}

}  // namespace heartservo::tracking
