#include "tracking/landmark/dense_pose.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "tracking/planar/simd/select.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tracking {

namespace {

constexpr int kSettled = 1;             // iterations after which the pixels stay the same
constexpr int kLastWeighing = 8;        // iterations; pixels that come and go must not keep the pose from settling
constexpr double kConverged = 1e-3;     // squared length of a step in standard deviations
constexpr double kLongestStep_px = 2;   // of a corner
constexpr double kSmallestSigma = 0.3;  // grey: rounding alone

/// Solution and inverse of A x = b, computed with every unknown in a unit that makes A's diagonal 1. False if singular.
template <int N>
bool solve_scaled(const Eigen::Matrix<double, N, N>& A, const Eigen::Matrix<double, N, 1>& b,
                  Eigen::Matrix<double, N, 1>& x, Eigen::Matrix<double, N, N>* inverse = nullptr) {
  const Eigen::Matrix<double, N, 1> scale = A.diagonal().cwiseSqrt().cwiseInverse();
  if (!scale.allFinite()) return false;
  const Eigen::LDLT<Eigen::Matrix<double, N, N>> ldlt(scale.asDiagonal() * A * scale.asDiagonal());
  if (ldlt.info() != Eigen::Success || !(ldlt.vectorD().minCoeff() > 1e-10)) return false;
  x = scale.asDiagonal() * ldlt.solve(scale.asDiagonal() * b);
  if (inverse) {
    const Eigen::Matrix<double, N, N> scaled = ldlt.solve(Eigen::Matrix<double, N, N>::Identity());
    *inverse = scale.asDiagonal() * scaled * scale.asDiagonal();
  }
  return x.allFinite();
}

double largest_move_px(const Camera& camera, const Eigen::Isometry3d& a, const Eigen::Isometry3d& b, double side_m) {
  const Quad qa = project_square(camera, a, side_m), qb = project_square(camera, b, side_m);
  double move = 0;
  for (int i = 0; i < 4; ++i) move = std::max(move, (qa[i] - qb[i]).norm());
  return std::isfinite(qa[0].sum() + qb[0].sum()) ? move : std::numeric_limits<double>::infinity();
}

}  // namespace

std::vector<std::string> DenseOptions::validate() const {
  std::vector<std::string> problems;
  if (max_iterations < 1) problems.emplace_back("max_iterations must be 1 or more");
  if (!(outlier_sigmas >= 1)) problems.emplace_back("outlier_sigmas must be 1 or more");
  if (!(saturated_grey > 0)) problems.emplace_back("saturated_grey must be positive");
  if (!(smallest_share >= 0 && smallest_share <= 1)) problems.emplace_back("smallest_share must lie in 0..1");
  if (smallest_pixels < 2 * kDenseParameters)
    problems.push_back(fmt::format("smallest_pixels must be {} or more", 2 * kDenseParameters));
  if (!(smallest_likeness >= 0 && smallest_likeness < 1))
    problems.emplace_back("smallest_likeness must lie in 0..1, below 1");
  if (!(largest_move_px > 0)) problems.emplace_back("largest_move_px must be positive");
  return problems;
}

DenseRefiner::DenseRefiner(const Camera& camera, const DenseOptions& options)
    : camera_(camera), options_(options), rays_(camera) {
  const auto problems = options.validate();
  if (!problems.empty()) throw ConfigError(fmt::format("dense pose: {}", fmt::join(problems, "; ")));
}

simd::DensePixels DenseRefiner::pixels() {
  return {count_, ray_x_.data(), ray_y_.data(), grey_.data(), residual_.data(), weight_.data()};
}

void DenseRefiner::collect(const cv::Mat& grey, const LandmarkTemplate& plate, double side_m,
                           const Eigen::Isometry3d& T) {
  count_ = region_pixels_ = 0;
  Eigen::Vector2d low = Eigen::Vector2d::Constant(1e9), high = -low;
  for (const auto& corner : project_square(camera_, T, side_m)) {
    low = low.cwiseMin(corner);
    high = high.cwiseMax(corner);
  }
  if (!low.allFinite() || !high.allFinite()) return;
  // The lens bends sides by far less than 3 px; what lies outside the picture is not seen.
  const auto from = [](double a) { return std::max(0, static_cast<int>(std::floor(std::max(a, -1e6))) - 3); };
  const auto to = [](double a, int size) {
    return std::min(size - 1, static_cast<int>(std::ceil(std::min(a, 1e6))) + 3);
  };
  const int left = from(low.x()), top = from(low.y()), right = to(high.x(), grey.cols), bottom = to(high.y(), grey.rows);
  if (right < left || bottom < top) return;
  const auto n = static_cast<std::size_t>(right - left + 1), most = n * static_cast<std::size_t>(bottom - top + 1);
  for (auto* values : {&ray_x_, &ray_y_, &grey_, &residual_, &weight_, &sizes_})
    simd::at_least(*values, most + 2 * simd::kDensePad);
  const simd::DenseJob job = simd::dense_job(plate, PlateView(T, side_m), DenseLight::Zero());
  for (int v = top; v <= bottom; ++v)
    count_ += simd::collect_row(job, rays_.row(left, v, n), grey.ptr(v) + left, n,
                                static_cast<float>(options_.saturated_grey), ray_x_.data() + count_,
                                ray_y_.data() + count_, grey_.data() + count_, region_pixels_);
  std::fill_n(weight_.begin(), count_, 1.0F);
  std::fill_n(weight_.begin() + static_cast<std::ptrdiff_t>(count_), simd::kDensePad, 0.0F);
}

bool DenseRefiner::first_light(const LandmarkTemplate& plate, const PlateView& view, DenseLight& light) {
  // Gain and bias alone: the finer parameters need a pose that fits.
  simd::sample_plate(simd::dense_job(plate, view, light), pixels());
  Eigen::Matrix2d A = Eigen::Matrix2d::Zero();
  Eigen::Vector2d b = Eigen::Vector2d::Zero(), x;
  for (std::size_t i = 0; i < count_; ++i) {
    const double T = static_cast<double>(residual_[i]), grey = static_cast<double>(grey_[i]);
    A(0, 0) += T * T, A(0, 1) += T;
    b(0) += T * grey, b(1) += grey;
  }
  A(1, 0) = A(0, 1), A(1, 1) = static_cast<double>(count_);
  if (!solve_scaled<2>(A, b, x) || !(x(0) > 0)) return false;
  light(0) = x(0), light(7) = x(1);
  const auto gain = static_cast<float>(x(0)), bias = static_cast<float>(x(1));
  for (std::size_t i = 0; i < count_; ++i) residual_[i] = grey_[i] - gain * residual_[i] - bias;
  return true;
}

void DenseRefiner::weigh() {
  if (count_ == 0) return;
  for (std::size_t i = 0; i < count_; ++i) sizes_[i] = std::abs(residual_[i]);
  std::fill_n(sizes_.begin() + static_cast<std::ptrdiff_t>(count_), simd::kDensePad,
              std::numeric_limits<float>::infinity());
  const double median = static_cast<double>(simd::select(sizes_.data(), count_, count_ / 2));
  const auto inverse = static_cast<float>(1 / (options_.outlier_sigmas * std::max(kSmallestSigma, 1.4826 * median)));
  for (std::size_t i = 0; i < count_; ++i) {
    const float over = std::max(0.0F, sizes_[i] * inverse - 1), w = std::max(0.0F, 1 - over * over);
    weight_[i] = w * w;
  }
}

double DenseRefiner::grey_variance() const {
  double w = 0, sum = 0, squares = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    const double weight = static_cast<double>(weight_[i]), grey = static_cast<double>(grey_[i]);
    w += weight;
    sum += weight * grey;
    squares += weight * grey * grey;
  }
  return w > 0 ? squares / w - sum * sum / (w * w) : 0;
}

DenseRefiner::Normal DenseRefiner::normal_equations(const LandmarkTemplate& plate, const PlateView& view,
                                                    const DenseLight& light) {
  Normal A = Normal::Zero();
  simd::add_normal(simd::dense_job(plate, view, light), pixels(), A.data());
  return A.selfadjointView<Eigen::Upper>();
}

DensePose DenseRefiner::refine(const cv::Mat& grey, const LandmarkTemplate& plate, double side_m,
                               const Eigen::Isometry3d& start) {
  DensePose result;
  if (plate.empty() || grey.type() != CV_8UC1 || grey.cols != camera_.width || grey.rows != camera_.height ||
      !(start.translation().z() > 0) || !start.matrix().allFinite())
    return result;
  Eigen::Isometry3d T = start;
  DenseLight light = DenseLight::Zero();
  DenseRow step;
  Eigen::Matrix<double, kDenseParameters, kDenseParameters> inverse;
  bool converged = false;
  Normal A;
  for (result.iterations = 0; result.iterations < options_.max_iterations; ++result.iterations) {
    if (result.iterations <= kSettled) collect(grey, plate, side_m, T);
    if (count_ < static_cast<std::size_t>(options_.smallest_pixels)) return result;
    const PlateView view(T, side_m);
    if (result.iterations == 0 && !first_light(plate, view, light)) return result;
    if (result.iterations > 0 && result.iterations <= kSettled) simd::predict(simd::dense_job(plate, view, light), pixels());
    if (result.iterations < kLastWeighing) weigh();  // later by the differences of the iteration before, which are nearly the same
    A = normal_equations(plate, view, light);
    if (!solve_scaled<kDenseParameters>(A.topLeftCorner<kDenseParameters, kDenseParameters>(),
                                        A.topRightCorner<kDenseParameters, 1>(), step, &inverse))
      return result;
    const double count = A(kDenseParameters - 1, kDenseParameters - 1);  // the bias' row is the sum of the weights
    if (count < options_.smallest_pixels) return result;
    const double variance = A(kDenseParameters, kDenseParameters) / std::max(1.0, count - kDenseParameters);
    Eigen::Matrix<double, 6, 1> twist = step.head<6>();
    const double move = largest_move_px(camera_, moved(T, twist), T, side_m);
    const double shorter = std::min(1.0, kLongestStep_px / std::max(move, 1e-9));
    T = moved(T, shorter * twist);
    light += shorter * step.tail<kLightParameters>();
    if (!(T.translation().z() > 0) || !(largest_move_px(camera_, T, start, side_m) < options_.largest_move_px))
      return result;
    result.rms_grey = std::sqrt(variance);
    result.pixels = count;
    result.covariance = variance * inverse.topLeftCorner<6, 6>();
    converged = result.iterations > kSettled &&
                step.dot(A.topLeftCorner<kDenseParameters, kDenseParameters>() * step) <
                    kConverged * std::max(variance, kSmallestSigma * kSmallestSigma);
    if (converged) break;
  }
  result.share = result.pixels / static_cast<double>(std::max<std::size_t>(1, region_pixels_));
  T.linear() = Eigen::Quaterniond(T.linear()).normalized().toRotationMatrix();
  result.T_camera_target = T;
  result.light = light;
  const double noise = std::max(result.rms_grey, kSmallestSigma);  // a plain picture is like nothing
  result.likeness = 1 - noise * noise / std::max(1e-9, grey_variance());
  result.valid = converged && result.share >= options_.smallest_share &&
                 result.likeness >= options_.smallest_likeness && result.covariance.allFinite();
  return result;
}

}  // namespace heartservo::tracking
