#include "tracking/depth/stereo_match.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "tracking/planar/patch.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tracking {

namespace {

constexpr int kLevels = 3, kIterations = 12;
constexpr int kParameters = 9;         // 1/z: value, two slopes, three curvatures; off the epipolar line; gain, bias
constexpr double kTukey = 4.685;       // 95 % efficiency on normal noise
constexpr double kSmallestNoise = 1;   // grey
constexpr double kSmallestVisible = 0.4;
constexpr double kSmallStep_px = 1e-3;
constexpr double kUniqueBy = 0.03;     // a second place whose correlation is less than that below the best is as good
constexpr double kOffEpipolar = 6;     // standard deviations
constexpr double kCurvatureSigma = 40;  // 1/m, of 1/z over the normalised plane squared: bends of a radius of some cm

using Vector = Eigen::Matrix<double, kParameters, 1>;
using Matrix = Eigen::Matrix<double, kParameters, kParameters>;

double median_of(std::vector<float>& values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return static_cast<double>(*middle);
}

}  // namespace

const char* name_of(StereoFailure failure) {
  switch (failure) {
    case StereoFailure::NONE: return "none";
    case StereoFailure::OUT_OF_PICTURE: return "out of the right picture";
    case StereoFailure::NOT_FOUND: return "not found along the epipolar line";
    case StereoFailure::AMBIGUOUS: return "found at several distances";
    case StereoFailure::BAD_FIT: return "the views do not fit";
    case StereoFailure::OFF_EPIPOLAR: return "far off the epipolar line";
  }
  return "";
}

std::vector<std::string> StereoOptions::validate() const {
  std::vector<std::string> problems;
  if (!(nearest_m > 0 && farthest_m > nearest_m) || !std::isfinite(farthest_m))
    problems.push_back(fmt::format("nearest_m is {} and farthest_m {}; must be positive and the second larger",
                                   nearest_m, farthest_m));
  if (!(window_px >= 15) || !std::isfinite(window_px))
    problems.push_back(fmt::format("window_px is {}; must be 15 or more", window_px));
  if (!(epipolar_sigma_px > 0) || !std::isfinite(epipolar_sigma_px))
    problems.push_back(fmt::format("epipolar_sigma_px is {}; must be positive", epipolar_sigma_px));
  if (!(uncertain_correlation >= 0 && ok_correlation >= uncertain_correlation && ok_correlation <= 1))
    problems.emplace_back("ok_correlation must lie between uncertain_correlation and 1");
  return problems;
}

struct StereoMatcher::Workspace {
  StereoCamera camera;
  StereoOptions options;
  ImagePyramid left_pyramid, right_pyramid;
  Patch patch;                            // of the left picture
  Eigen::Matrix3d G;                      // of the window
  Eigen::Vector2d centre;                 // normalised, left
  Eigen::Vector2d across;                 // unit, normalised plane of the right camera, off the epipolar line
  std::vector<Eigen::Vector2d> plane;     // left normalised points, less the centre
  std::vector<float> x, y, zero, grey, inside, residual, weight, sorted, scratch;
  std::vector<Eigen::Matrix<double, 2, 7>> geometry;

  Eigen::Vector3d right_ray(std::size_t i, double inverse_depth) const {
    return camera.T_right_left.linear() * (plane[i] + centre).homogeneous() +
           inverse_depth * camera.T_right_left.translation();
  }

  // 1/z at the point, by the first six parameters.
  static double inverse_depth(const Vector& p, const Eigen::Vector2d& d) {
    return p[0] + p[1] * d.x() + p[2] * d.y() + p[3] * d.x() * d.x() + p[4] * d.x() * d.y() + p[5] * d.y() * d.y();
  }

  void learn(int level, double side_px);
  bool place(const Vector& p);
  void sample(int level, Interpolation how);
  double correlation(bool weighted) const;
  double noise(const Vector& p);
  bool refine(int level, Vector& p, Matrix& information, StereoMatch& match);
  StereoFailure search(double side_px, double& inverse_depth);
};

// The window's grey values and rays at a level of the pyramid.
void StereoMatcher::Workspace::learn(int level, double side_px) {
  const int side = std::max(9, static_cast<int>(std::lround(side_px)) >> level);
  make_patch(left_pyramid.level(level), camera.left, G, side, side, patch, scratch);
  const std::size_t n = patch.size();
  plane.resize(n);
  geometry.resize(n);
  for (auto* buffer : {&x, &y, &grey, &inside, &residual, &weight}) buffer->resize(n);
  zero.assign(n, 0);
  for (int row = 0; row < patch.height; ++row)
    for (int column = 0; column < patch.width; ++column)
      plane[static_cast<std::size_t>(row * patch.width + column)] =
          (G * Eigen::Vector3d(patch.x_of(column), patch.y_of(row), 1)).hnormalized() - centre;
}

// Where the window's points lie on the right normalised plane, and how that depends on the parameters; false where some
// lie behind a camera.
bool StereoMatcher::Workspace::place(const Vector& p) {
  const Eigen::Vector3d& t = camera.T_right_left.translation();
  for (std::size_t i = 0; i < plane.size(); ++i) {
    const Eigen::Vector2d& d = plane[i];
    const double rho = inverse_depth(p, d);
    const Eigen::Vector3d q = right_ray(i, rho);
    if (!(q.z() > 0.05) || !(rho > 0)) return false;
    const Eigen::Vector2d n = q.hnormalized();
    const Eigen::Vector2d by_rho = (t.head<2>() - n * t.z()) / q.z();
    geometry[i].col(0) = by_rho;
    geometry[i].col(1) = by_rho * d.x();
    geometry[i].col(2) = by_rho * d.y();
    geometry[i].col(3) = by_rho * (d.x() * d.x());
    geometry[i].col(4) = by_rho * (d.x() * d.y());
    geometry[i].col(5) = by_rho * (d.y() * d.y());
    geometry[i].col(6) = across;
    x[i] = static_cast<float>(n.x() + p[6] * across.x());
    y[i] = static_cast<float>(n.y() + p[6] * across.y());
  }
  return true;
}

void StereoMatcher::Workspace::sample(int level, Interpolation how) {
  warp(right_pyramid.level(level), camera.right, Eigen::Matrix3d::Identity(), patch, how, grey.data(), inside.data(),
       {x.data(), y.data(), zero.data()});
  for (std::size_t i = 0; i < grey.size(); ++i)
    if (grey[i] >= kSaturatedGrey) inside[i] = 0;
}

double StereoMatcher::Workspace::correlation(bool weighted) const {
  double n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;
  for (std::size_t i = 0; i < grey.size(); ++i) {
    const double w = static_cast<double>(patch.usable[i] * inside[i] * (weighted ? weight[i] : 1));
    const double l = static_cast<double>(patch.grey[i]), r = static_cast<double>(grey[i]);
    n += w, a += w * l, b += w * r, aa += w * l * l, bb += w * r * r, ab += w * l * r;
  }
  if (!(n > 0)) return 0;
  const double product = (aa - a * a / n) * (bb - b * b / n);
  return product > 0 ? (ab - a * b / n) / std::sqrt(product) : 0;
}

// Fills residual = gain right + bias - left and its robust weights; the noise's standard deviation.
double StereoMatcher::Workspace::noise(const Vector& p) {
  sorted.clear();
  for (std::size_t i = 0; i < grey.size(); ++i) {
    residual[i] = static_cast<float>(p[7]) * grey[i] + static_cast<float>(p[8]) - patch.grey[i];
    if (patch.usable[i] * inside[i] > 0) sorted.push_back(std::abs(residual[i]));
  }
  const double sigma = std::max(kSmallestNoise, 1.4826 * median_of(sorted));
  for (std::size_t i = 0; i < grey.size(); ++i) {
    const double u = static_cast<double>(residual[i]) / (kTukey * sigma), left = 1 - u * u;
    weight[i] = left > 0 ? static_cast<float>(left * left) : 0.F;
  }
  return sigma;
}

// Gauss-Newton on the grey values, with the mean of both pictures' gradients as in the efficient second-order
// minimisation. False where it leaves the picture or the equations are singular.
bool StereoMatcher::Workspace::refine(int level, Vector& p, Matrix& information, StereoMatch& match) {
  const Vector start = p;
  const double px = std::sqrt(camera.right.fx * camera.right.fy);
  const auto w = static_cast<std::size_t>(patch.width);
  double usable = 0;
  for (const float u : patch.usable) usable += static_cast<double>(u);
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    if (!place(p)) return false;
    sample(level, Interpolation::CUBIC);
    const double sigma = noise(p);
    information.setZero();
    Vector right = Vector::Zero();
    double believed = 0;
    for (int row = 1; row + 1 < patch.height; ++row)
      for (int column = 1; column + 1 < patch.width; ++column) {
        const std::size_t i = static_cast<std::size_t>(row) * w + static_cast<std::size_t>(column);
        if (!(patch.usable[i] > 0 && inside[i - 1] * inside[i + 1] * inside[i - w] * inside[i + w] * inside[i] > 0))
          continue;
        const double believe = static_cast<double>(weight[i]);
        if (!(believe > 0)) continue;
        believed += believe;
        // gradient per grid step of both, and the grid's steps on the right normalised plane
        const Eigen::RowVector2d of_right(0.5 * static_cast<double>(grey[i + 1] - grey[i - 1]),
                                          0.5 * static_cast<double>(grey[i + w] - grey[i - w]));
        const Eigen::RowVector2d of_left(static_cast<double>(patch.gradient_x[i] * patch.step),
                                         static_cast<double>(patch.gradient_y[i] * patch.step));
        Eigen::Matrix2d steps;
        steps << x[i + 1] - x[i - 1], x[i + w] - x[i - w], y[i + 1] - y[i - 1], y[i + w] - y[i - w];
        steps *= 0.5;
        Eigen::Matrix<double, 1, kParameters> J;
        J.head<7>() = 0.5 * (p[7] * of_right + of_left) * steps.inverse() * geometry[i];
        J[7] = static_cast<double>(grey[i]);
        J[8] = 1;
        information.noalias() += believe * J.transpose() * J;
        right.noalias() -= believe * J.transpose() * static_cast<double>(residual[i]);
      }
    match.visible = usable > 0 ? believed / usable : 0;
    match.noise_grey = sigma;
    if (match.visible < kSmallestVisible * 0.5) return false;
    information /= sigma * sigma;
    right /= sigma * sigma;
    // the calibration's error across the lines, and how much tissue bends
    const double across_weight = std::pow(px / options.epipolar_sigma_px, 2);
    information(6, 6) += across_weight;
    right[6] -= across_weight * p[6];
    for (int k = 3; k < 6; ++k) {
      const double bend_weight = 1 / (kCurvatureSigma * kCurvatureSigma);
      information(k, k) += bend_weight;
      right[k] -= bend_weight * p[k];
    }
    const Eigen::LDLT<Matrix> solver(information);
    const Vector step = solver.solve(right);
    if (solver.info() != Eigen::Success || !step.allFinite()) return false;
    p += step;
    const double disparity_px = px * camera.baseline_m() * std::abs(step[0]);
    if (px * camera.baseline_m() * std::abs(p[0] - start[0]) > 12 * (1 << level)) return false;  // ran away
    if (disparity_px < kSmallStep_px && std::abs(px * step[6]) < kSmallStep_px) break;
  }
  return true;
}

// The inverse depth of the best correlation along the epipolar line, a pixel of the coarse level at a time.
StereoFailure StereoMatcher::Workspace::search(double side_px, double& found) {
  const int level = side_px >= 60 ? 2 : side_px >= 25 ? 1 : 0;
  learn(level, side_px);
  const double step = (1 << level) / (camera.right.fx * camera.baseline_m());
  const double first = 1 / options.farthest_m, last = 1 / options.nearest_m;
  double best = -1, second = -1, inside_most = 0;
  found = 0;
  std::vector<std::pair<double, double>> scores;  // inverse depth, correlation
  Vector p = Vector::Zero();
  double usable = 0;
  for (const float u : patch.usable) usable += static_cast<double>(u);
  for (double rho = first; rho <= last; rho += step) {
    p[0] = rho;
    if (!place(p)) continue;
    sample(level, Interpolation::LINEAR);
    double in = 0;
    for (std::size_t i = 0; i < grey.size(); ++i) in += static_cast<double>(patch.usable[i] * inside[i]);
    inside_most = std::max(inside_most, in);
    const double score = in > kSmallestVisible * usable ? correlation(false) : -1;
    scores.emplace_back(rho, score);
    if (score > best) best = score, found = rho;
  }
  if (!(inside_most > kSmallestVisible * usable)) return StereoFailure::OUT_OF_PICTURE;
  if (best < 0.7 * options.uncertain_correlation) return StereoFailure::NOT_FOUND;
  // as good elsewhere: a peak of its own, not the flank of the best
  for (std::size_t i = 1; i + 1 < scores.size(); ++i)
    if (std::abs(scores[i].first - found) > 3 * step && scores[i].second >= scores[i - 1].second &&
        scores[i].second >= scores[i + 1].second)
      second = std::max(second, scores[i].second);
  return best - second < kUniqueBy ? StereoFailure::AMBIGUOUS : StereoFailure::NONE;
}

StereoMatcher::StereoMatcher(const StereoCamera& camera, const StereoOptions& options)
    : w_(std::make_unique<Workspace>()) {
  auto problems = camera.validate();
  for (const auto& problem : options.validate()) problems.push_back(problem);
  if (!problems.empty()) throw ConfigError(fmt::format("stereo: {}", fmt::join(problems, "; ")));
  w_->camera = camera;
  w_->options = options;
}

StereoMatcher::~StereoMatcher() = default;

const StereoCamera& StereoMatcher::camera() const { return w_->camera; }

StereoMatch StereoMatcher::match(const cv::Mat& left, const cv::Mat& right, const Eigen::Matrix3d& G_plane_patch,
                                 double side_px, const std::optional<StereoMatch>& near) {
  Workspace& w = *w_;
  StereoMatch match;
  const double share = std::min(1.0, w.options.window_px / side_px);
  const double window_px = share * side_px;
  w.G = G_plane_patch * Eigen::Vector3d(share, share, 1).asDiagonal();
  w.centre = w.G.col(2).hnormalized();
  const cv::Size size(w.camera.left.width, w.camera.left.height);
  for (const cv::Mat* picture : {&left, &right})
    if (picture->size() != size || picture->type() != CV_8UC1) return match;
  if (!w.centre.allFinite()) return match;
  w.left_pyramid.build(left, cv::Rect(0, 0, left.cols, left.rows), kLevels);
  w.right_pyramid.build(right, cv::Rect(0, 0, right.cols, right.rows), kLevels);
  const Eigen::Vector3d& t = w.camera.T_right_left.translation();
  const auto set_across = [&](double rho) {
    const Eigen::Vector3d q = w.camera.T_right_left.linear() * w.centre.homogeneous() + rho * t;
    const Eigen::Vector2d along = t.head<2>() - q.hnormalized() * t.z();
    w.across = Eigen::Vector2d(-along.y(), along.x()).normalized();
  };
  Vector p = Vector::Zero();
  p[7] = 1;
  Matrix information;
  const auto fit = [&](int coarsest) {
    set_across(p[0]);
    bool good = true;
    for (int level = coarsest; good && level >= 0; --level) {
      w.learn(level, window_px);
      good = w.refine(level, p, information, match);
    }
    return good && w.correlation(true) >= w.options.uncertain_correlation && match.visible >= kSmallestVisible;
  };
  bool good = false;
  if (near && near->failure == StereoFailure::NONE) {
    p[0] = 1 / near->depth_m;
    p.segment<2>(1) = near->gradient;
    good = fit(1);
  }
  if (!good) {
    p.setZero();
    p[7] = 1;
    set_across(1 / w.options.farthest_m);
    match.failure = w.search(window_px, p[0]);
    if (match.failure != StereoFailure::NONE) return match;
    good = fit(window_px >= 60 ? 2 : 1);
  }
  match.failure = StereoFailure::BAD_FIT;
  match.correlation = w.correlation(true);
  if (!good || !(p[0] >= 1 / w.options.farthest_m && p[0] <= 1 / w.options.nearest_m)) return match;
  match.epipolar_px = p[6] * std::sqrt(w.camera.right.fx * w.camera.right.fy);
  match.depth_m = 1 / p[0];
  match.gradient = p.segment<2>(1);
  const double variance = information.inverse()(0, 0);
  match.sigma_m = match.depth_m * match.depth_m * std::sqrt(variance);
  if (!(variance > 0) || !std::isfinite(match.sigma_m)) return match;
  match.failure = std::abs(match.epipolar_px) > kOffEpipolar * w.options.epipolar_sigma_px ? StereoFailure::OFF_EPIPOLAR
                                                                                           : StereoFailure::NONE;
  return match;
}

}  // namespace heartservo::tracking
