#include "tracking/depth/region_depth_estimator.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "tracking/settings/errors.hpp"

namespace heartservo::tracking {

namespace {

constexpr int kIterations = 10;
constexpr double kSmallStep = 1e-7;          // of the first distance, rad
constexpr double kTurnSigma = 1.5;           // rad, about the line of sight: anything
constexpr double kLargestChangeOfDepth = 3;  // nearer or farther than that by a factor: no view of the region

Eigen::Vector3d logarithm(const Eigen::Matrix3d& R) {
  const Eigen::AngleAxisd turn(R);
  return turn.angle() * turn.axis();
}

}  // namespace

std::vector<std::string> DepthOptions::validate() const {
  std::vector<std::string> problems;
  const auto positive = [&](const char* name, double value) {
    if (!(value > 0) || !std::isfinite(value)) problems.push_back(fmt::format("{} is {}; must be positive", name, value));
  };
  positive("wander_sigma_m", wander_sigma_m);
  positive("wander_length_m", wander_length_m);
  positive("tilt_sigma_rad", tilt_sigma_rad);
  positive("curvature_sigma", curvature_sigma);
  positive("memory_s", memory_s);
  if (!(bulge_sigma_m >= 0) || !std::isfinite(bulge_sigma_m))
    problems.push_back(fmt::format("bulge_sigma_m is {}; must not be negative", bulge_sigma_m));
  return problems;
}

RegionDepthEstimator::RegionDepthEstimator(const Camera& camera, ScaleSource scale, const DepthOptions& options,
                                           double point_sigma_px)
    : camera_(camera), source_(std::move(scale)), options_(options), point_sigma_px_(point_sigma_px) {
  auto problems = options.validate();
  if (!source_) problems.emplace_back("the region's distance must be known once (depth.source)");
  if (!(point_sigma_px > 0) || !std::isfinite(point_sigma_px))
    problems.push_back(fmt::format("corner sigma is {} px; must be positive", point_sigma_px));
  if (!problems.empty()) throw ConfigError(fmt::format("depth of a region: {}", fmt::join(problems, "; ")));
}

TargetState RegionDepthEstimator::estimate(const Track& track) {
  TargetState state;
  state.time_s = track.time_s;
  state.sequence = track.sequence;
  state.quality = track.quality;
  if (track.state == TrackState::LOST) return state;
  if (!model_ && !begin(track)) return state;
  for (std::size_t i = 0; i < track.points.size(); ++i)
    seen_.segment<2>(2 * static_cast<Eigen::Index>(i)) = camera_.normalise(track.points[i]);
  if (!seen_.allFinite()) return state;
  SurfacePose pose = last_;
  SurfaceShape shape = shape_;
  Matrix11 covariance;
  if (!solve(pose, shape, covariance)) return state;
  report(track, pose, shape, covariance, state);
  if (state.state == TrackState::OK) {
    last_ = pose;
    learn_shape(track.time_s, shape, covariance);
  }
  return state;
}

bool RegionDepthEstimator::begin(const Track& track) {
  const ScaleReference scale = source_(frame_, track);
  if (!scale.validate().empty()) return false;
  std::vector<Eigen::Vector2d> rays;
  for (const auto& point : track.points) rays.push_back(camera_.normalise(point));
  const Eigen::Vector2d centre = camera_.normalise(track.target);
  if (!centre.allFinite() || std::any_of(rays.begin(), rays.end(), [](const auto& r) { return !r.allFinite(); }))
    return false;
  scale_ = scale;
  noise_ = point_sigma_px_ / std::sqrt(camera_.fx * camera_.fy);
  prior_ = deformation_prior(rays, centre, scale.depth_m, noise_, options_);
  const auto n = 2 * static_cast<Eigen::Index>(rays.size());
  model_.emplace(std::move(rays), centre);
  seen_.resize(n), expected_.resize(n), residual_.resize(n);
  J_pose_.resize(n, 6), J_shape_.resize(n, 5), J_.resize(n, 11), WJ_.resize(n, 11);
  shape_ << scale.slope, 0, 0, 0;
  const double bend = options_.curvature_sigma * scale.depth_m;
  SurfaceShape sigma;
  sigma << scale.slope_sigma, scale.slope_sigma, bend, bend / 2, bend;
  shape_covariance_ = sigma.cwiseAbs2().asDiagonal();
  last_ = {centre.homogeneous(), Eigen::Matrix3d::Identity()};
  last_time_s_ = track.time_s;
  return true;
}

// `covariance`: of (twist, shape); J_ and WJ_ are left as of the last step.
bool RegionDepthEstimator::solve(SurfacePose& pose, SurfaceShape& shape, Matrix11& covariance) {
  const Eigen::Vector3d turn_weight(std::pow(options_.tilt_sigma_rad, -2), std::pow(options_.tilt_sigma_rad, -2),
                                    std::pow(kTurnSigma, -2));
  const Eigen::Matrix<double, 5, 5> shape_weight = shape_covariance_.inverse();
  for (int i = 0; i < kIterations; ++i) {
    if (!model_->view(pose, shape, expected_, J_pose_, J_shape_)) return false;
    J_ << J_pose_, J_shape_;
    WJ_.noalias() = prior_.weight * J_;
    Matrix11 information = J_.transpose() * WJ_;
    residual_ = seen_ - expected_;
    Vector11 right = WJ_.transpose() * residual_;
    information.block<3, 3>(3, 3).diagonal() += turn_weight;
    right.segment<3>(3) -= turn_weight.cwiseProduct(logarithm(pose.rotation));
    information.bottomRightCorner<5, 5>() += shape_weight;
    right.tail<5>() -= shape_weight * (shape - shape_);
    const Eigen::LDLT<Matrix11> solver(information);
    const Vector11 step = solver.solve(right);
    if (solver.info() != Eigen::Success || !step.allFinite()) return false;
    covariance = solver.solve(Matrix11::Identity());
    pose = moved(pose, step.head<6>());
    shape += step.tail<5>();
    if (step.cwiseAbs().maxCoeff() < kSmallStep) break;
  }
  const double z = pose.position.z();
  return z > 1 / kLargestChangeOfDepth && z < kLargestChangeOfDepth;
}

// The depth is that of the surface moved as a whole, and the centre's own way across it as far as its neighbours show
// it (universal kriging). Sideways the centre is seen itself.
void RegionDepthEstimator::report(const Track& track, const SurfacePose& pose, const SurfaceShape& shape,
                                  const Matrix11& covariance, TargetState& state) {
  model_->view(pose, shape, expected_, J_pose_, J_shape_);
  const Eigen::VectorXd& kriging = prior_.kriging;
  residual_ = seen_ - expected_;
  const double z = pose.position.z() + kriging.dot(residual_);
  const Eigen::Vector3d ray = camera_.normalise(track.target).homogeneous();
  if (!ray.allFinite() || !(z > 0)) return;
  state.state = track.state;
  state.T_camera_target.translation() = scale_.depth_m * z * ray;
  state.T_camera_target.linear() = pose.rotation;
  // d z / d parameters, once the own way has been taken from what they leave
  Vector11 trend;
  trend.noalias() = J_.transpose() * kriging;  // straight into it: the product's size is only known at run time
  trend = -trend;
  trend[2] += 1;
  const double variance =
      prior_.centre_variance - prior_.with_centre.dot(kriging) + trend.dot(covariance * trend);
  residual_.noalias() = WJ_ * (covariance * trend);  // d z / d points
  residual_ += kriging;
  const double by_noise = noise_ * noise_ * residual_.squaredNorm();
  const double relative = scale_.sigma_m / scale_.depth_m, unit = scale_.depth_m * scale_.depth_m;
  const Eigen::Matrix3d along = unit * ray * ray.transpose();
  const Eigen::Matrix2d J =
      (Eigen::Vector2d(camera_.fx, camera_.fy).asDiagonal() * camera_.distort_jacobian(ray.head<2>())).inverse() *
      (scale_.depth_m * z);
  state.position_covariance = by_noise * along;
  state.position_covariance.topLeftCorner<2, 2>() += J * J.transpose() * (point_sigma_px_ * point_sigma_px_);
  state.lasting_covariance = (std::max(0.0, variance - by_noise) + relative * relative * z * z) * along;
}

// What a frame says of the shape counts in full only where its errors are new: deformation lasts for many frames.
void RegionDepthEstimator::learn_shape(double time_s, const SurfaceShape& shape, const Matrix11& covariance) {
  const double share = std::clamp((time_s - last_time_s_) / options_.memory_s, 0.0, 1.0);
  last_time_s_ = time_s;
  if (share <= 0) return;
  using Matrix5 = Eigen::Matrix<double, 5, 5>;
  const Matrix5 before = shape_covariance_.inverse(), after = covariance.bottomRightCorner<5, 5>().inverse();
  const Matrix5 kept = (before + share * (after - before)).inverse();
  // the frame's own step towards what it says, taken by that share of its information
  shape_ += kept * (share * (after * (shape - shape_)));
  shape_covariance_ = 0.5 * (kept + kept.transpose());
}

}  // namespace heartservo::tracking
