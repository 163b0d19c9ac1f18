#include "tracking/landmark/dense_estimator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tracking/frames/frame.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tracking {

namespace {

constexpr double kBlur_px = 0.5;        // of lens and sensor, to begin with
constexpr double kBlurMisfit = 0.3;     // of the blur's variance; beyond, the template is made anew
constexpr int kMostBlurChanges = 12;    // then the picture's sharpness varies, and the fit's own term follows it
constexpr double kNoDoubt = 30;         // chi2 by which the corners must prefer a side for the other not to be tried
constexpr double kSameSide = 0.005;     // rad

double angle_between(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return Eigen::AngleAxisd(Eigen::Matrix3d(a.linear().transpose() * b.linear())).angle();
}

}  // namespace

DenseEstimator::DenseEstimator(const Camera& camera, double side_m, const cv::Mat& plate, double corner_sigma_px,
                               const DenseOptions& options)
    : camera_(camera),
      side_m_(side_m),
      plate_(plate),
      corners_(camera, side_m, "refined", corner_sigma_px),
      refiner_(camera, options),
      learner_(camera) {
  if (!plate.empty() && (plate.type() != CV_8UC1 || plate.rows != plate.cols || plate.cols < 64))
    throw ConfigError(fmt::format(
        "the landmark's picture has {} x {} px{}; it must be square, grey, 64 px or more, cut at the plate's outline",
        plate.cols, plate.rows, plate.type() == CV_8UC1 ? "" : " and is not 8 bit grey"));
}

void DenseEstimator::look_at(const Frame& frame) {
  grey_ = frame.grey;
  sequence_ = frame.sequence;
}

TargetState DenseEstimator::estimate(const Track& track) {
  dense_ = DensePose{};
  TargetState state = corners_.estimate(track);
  if (state.state == TrackState::LOST || grey_.type() != CV_8UC1 || grey_.empty() || sequence_ != track.sequence)
    return state;
  if (template_.empty()) {
    if (plate_.empty()) {
      if (state.state != TrackState::OK) return state;
      DenseLight plain = DenseLight::Zero();
      plain(0) = 1;
      template_ = learner_.learn(grey_, side_m_, state.T_camera_target, plain);
      if (template_.empty()) return state;
    } else {
      template_ = LandmarkTemplate(plate_, 2 * kBlur_px / std::sqrt(area(track.corners)));
    }
  }
  dense_ = better_side(state);
  if (!dense_.valid) return state;
  state.T_camera_target = dense_.T_camera_target;
  state.position_covariance = dense_.covariance.topLeftCorner<3, 3>();
  if (plate_.empty() && !learner_.done() && state.state == TrackState::OK) {
    LandmarkTemplate more = learner_.learn(grey_, side_m_, dense_.T_camera_target, dense_.light);
    if (!more.empty()) template_ = std::move(more);
  }
  return state;
}

// The pose near `state`, with a template as sharp as the picture.
DensePose DenseEstimator::refine(const TargetState& state) {
  DensePose dense = refiner_.refine(grey_, template_, side_m_, state.T_camera_target);
  for (const double ratio : {2.0, 0.5}) {  // further off than the fit's own term can follow
    if (dense.valid || plate_.empty() || blur_found_ || blur_changes_ >= kMostBlurChanges) break;
    ++blur_changes_;
    LandmarkTemplate other(plate_, ratio * template_.blur());
    dense = refiner_.refine(grey_, other, side_m_, state.T_camera_target);
    if (dense.valid) template_ = std::move(other);
  }
  blur_found_ |= dense.valid;
  while (dense.valid && !plate_.empty() && blur_changes_ < kMostBlurChanges) {
    const double excess = dense.light(6) / dense.light(0);
    if (!(std::abs(excess) > kBlurMisfit)) break;
    ++blur_changes_;
    template_ = LandmarkTemplate(plate_, template_.blur() * std::sqrt(std::clamp(1 + excess, 0.25, 4.0)));
    dense = refiner_.refine(grey_, template_, side_m_, dense.T_camera_target);
  }
  return dense;
}

DensePose DenseEstimator::better_side(const TargetState& state) {
  const RefinedPose& corners = corners_.last_refined();
  const auto &taken = corners.solutions[corners.taken], &other = corners.solutions[1 - corners.taken];
  std::array<DensePose, 2> sides;
  sides[0] = refine(state);
  if (std::abs(taken.chi2 - other.chi2) < kNoDoubt &&
      angle_between(taken.T_camera_target, other.T_camera_target) > kSameSide)
    sides[1] = refiner_.refine(grey_, template_, side_m_, other.T_camera_target);
  if (!sides[0].valid && !sides[1].valid) return sides[0];
  // Squared differences in units of the noise that the better fit shows, over as many pixels.
  std::array<double, 2> chi2;
  SideFilter::Rotations rotations;
  double variance = std::numeric_limits<double>::infinity(), pixels = variance;
  for (const auto& side : sides)
    if (side.valid) {
      variance = std::min(variance, side.rms_grey * side.rms_grey);
      pixels = std::min(pixels, side.pixels);
    }
  for (int i = 0; i < 2; ++i) {
    rotations[i] = sides[i].T_camera_target.linear();
    chi2[i] = sides[i].valid ? pixels * (sides[i].rms_grey * sides[i].rms_grey / std::max(variance, 1e-6))
                             : std::numeric_limits<double>::infinity();
  }
  const auto& C = sides[sides[0].valid ? 0 : 1].covariance;
  const double sigma = std::sqrt(C.diagonal().tail<3>().maxCoeff());
  const auto log_p = state.state == TrackState::OK
                         ? sides_.keep(state.time_s, rotations, chi2, sigma)
                         : sides_.log_probabilities(state.time_s, rotations, chi2, sigma);
  return sides[log_p[1] > log_p[0] ? 1 : 0];
}

}  // namespace heartservo::tracking
