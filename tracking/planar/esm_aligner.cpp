#include "tracking/planar/esm_aligner.hpp"

#include <Eigen/Cholesky>
#include <cmath>

#include "tracking/planar/bent_grid.hpp"
#include "tracking/planar/normal_equations.hpp"
#include "tracking/planar/sl3.hpp"

namespace heartservo::tracking {

namespace {

constexpr int kSmallestSide = 9;            // points; a coarser template says nothing
constexpr std::size_t kAffinePoints = 500;  // fewer tell a shift, but with glare on them no shape
constexpr double kNotThere = 2 * kTukey;    // beside the place the texture itself is what differs
constexpr double kKnownNoise = 0.8;         // share of the gradient's noise that is certainly there
constexpr double kNear_px = 0.25;           // where bilinear sampling has done its part
constexpr double kNearCoarse_px = 0.1;      // of a coarse level: as little as its points tell
constexpr double kLeftOfStep = 0.2;         // near the place, at most: how far off the next step would still be
constexpr double kNewMatrix_px = 0.3;       // a step this long wants a new matrix after it
constexpr int kLastIterations = 5;          // with cubic sampling
constexpr double kSmallestShare = 0.3;      // of the template's points must be in the picture
constexpr double kHopeless = 0.6;           // fit at a coarse level that no finer one mends

using Matrix8d = Eigen::Matrix<double, 8, 8>;

// What the noise adds to J^T J by its own gradient: the curvature of the cost is that much smaller, and steps would
// stop short of the minimum where there is little texture.
Matrix8d gradient_noise(const Patch& patch) {
  Matrix8d sum = Matrix8d::Zero();
  for (int row = 0; row < patch.height; ++row)
    for (int column = 0; column < patch.width; ++column) {
      const double usable = static_cast<double>(patch.usable[static_cast<std::size_t>(row * patch.width + column)]);
      const Eigen::Matrix<double, 2, 8> J = sl3_point_jacobian(patch.x_of(column), patch.y_of(row));
      sum += usable * J.transpose() * J;
    }
  const double share = static_cast<double>(patch.template_share), noise = static_cast<double>(patch.gradient_noise);
  return noise * noise * (share * share + (1 - share) * (1 - share)) * sum;
}

class EsmAligner final : public PatchAligner {
 public:
  explicit EsmAligner(const EsmOptions& options) : options_(options) {}

  void learn(const ImagePyramid& picture, const Camera& camera, const Eigen::Matrix3d& G, int side_x,
             int side_y) override {
    camera_ = camera;
    patches_.clear();
    references_.clear();
    noise_.clear();
    grids_.clear();
    for (int level = 0; level < picture.levels(); ++level) {
      const int width = (side_x >> level) + 1, height = (side_y >> level) + 1;
      if (level > 0 && std::min(width, height) < kSmallestSide) break;
      patches_.push_back(make_patch(picture.level(level), camera, G, width, height));
      quieten_gradient(patches_.back());
      references_.emplace_back(patches_.back());
      noise_.push_back(gradient_noise(patches_.back()));
      if (options_.cell_px > 0) grids_.emplace_back(bend_of(side_x, side_y, options_.cell_px), patches_.back());
    }
    half_side_px_ = 0.5 * std::max(side_x, side_y);
    buffers_.resize(patches_.front().size());
  }

  const Patch& patch(int level) const override {
    return patches_[static_cast<std::size_t>(std::min(level, static_cast<int>(patches_.size()) - 1))];
  }

  Alignment align(const ImagePyramid& picture, const Alignment& start, int coarsest, MotionModel model) override {
    Alignment a = start;
    a.iterations = 0;
    moved_.setZero();
    matrix_level_ = -1;
    start_gain_ = start.gain;
    wide_ = model != MotionModel::HOMOGRAPHY;
    coarsest = std::min({coarsest, picture.levels() - 1, static_cast<int>(patches_.size()) - 1});
    // Bilinear sampling to come near, cubic for the last steps. A coarse level has too few points for the perspective
    // terms: affine is enough to come near.
    for (int level = coarsest; level >= 0; --level) {
      const MotionModel at_level = level > 0 ? coarse_model(level) : model;
      if (!descend(picture.level(level), level, Interpolation::LINEAR, at_level, options_.max_iterations,
                   level > 0 ? kNearCoarse_px * (1 << level) : kNear_px, a))
        return a;
      a.converged = false;
      if (level > 0 && at_level != MotionModel::TRANSLATION && a.fit() < kHopeless) return a;
    }
    a.converged = descend(picture.level(0), 0, Interpolation::CUBIC, model, kLastIterations, options_.step_px, a);
    return a;
  }

 private:
  MotionModel coarse_model(int level) const {
    return patches_[static_cast<std::size_t>(level)].size() < kAffinePoints ? MotionModel::TRANSLATION
                                                                            : MotionModel::AFFINE;
  }

  // Iterates until no corner is likely to be further off than `step_px`; false when there is nothing to align with. What the last
  // pass saw is what the alignment is judged by: the step after it is too small to matter.
  bool descend(const PyramidLevel& picture, int level, Interpolation interpolation, MotionModel model, int iterations,
               double step_px, Alignment& a) {
    const auto l = static_cast<std::size_t>(level);
    const Patch& patch = patches_[l];
    const simd::EsmTemplate& reference = references_[l];
    a.converged = false;
    BentPoints bent;
    if (a.bend.cols() > 0 && !grids_.empty()) bent = grids_[l].bend(a.bend);
    // few parameters cannot run away with what hides the region, and may look further
    const bool wide = interpolation == Interpolation::LINEAR && wide_;
    for (int i = 0; i < iterations; ++i) {
      ++a.iterations;
      warp(picture, camera_, a.G_plane_patch, patch, interpolation, buffers_.grey.data(), nullptr, bent);
      const Light light{a.gain, a.bias, bent.gain_offset};
      // Near the end the matrix of the pass before is as good: it only says how far to step, not where to end.
      const bool same_matrix = matrix_level_ == level && last_step_px_ < kNewMatrix_px;
      esm_pass(reference, light, buffers_, pass_, !same_matrix, wide ? kNotThere : kTukey);
      if (pass_.points < kSmallestShare * reference.usable) return false;
      if (!same_matrix) {
        matrix_level_ = level;
        matrix_weight_ = pass_.weight;
      }
      Vector10d step;
      if (!solve(pass_, level, static_cast<int>(model), step)) return false;
      moved_ += step;
      const Eigen::Matrix3d M = sl3_exp(step.head<8>());
      a.G_plane_patch = to_sl3(a.G_plane_patch * M);
      const double most = start_gain_ * (1 + options_.gain_change), least = start_gain_ / (1 + options_.gain_change);
      const double wanted_gain = a.gain + step[8];
      a.gain = std::clamp(wanted_gain, least, most);
      // what the gain may not do to the mean grey of the region, the bias has to
      if (pass_.JtJ(9, 9) > 0) a.bias += (wanted_gain - a.gain) * pass_.JtJ(8, 9) / pass_.JtJ(9, 9);
      a.bias += step[9];
      if (!a.G_plane_patch.allFinite() || !(a.gain > 0.05 && a.gain < 20)) return false;
      last_step_px_ = corner_step(M) * half_side_px_;
      const double left_px = interpolation == Interpolation::CUBIC ? kLeftOfStep * last_step_px_ : last_step_px_;
      const bool last = left_px < step_px || i + 1 == iterations;
      if (last) judge(light, reference, a);
      if (last) break;
    }
    return true;
  }

  // Solves for the first parameters of SL(3) and the two of the illumination. The shape is tied to that of the start,
  // as loosely as it may change between two frames, weighed against the noise: where texture or light leave it open, it
  // stays instead of running away (a maximum a posteriori estimate).
  bool solve(const AlignmentPass& pass, int level, int parameters, Vector10d& step) const {
    const auto l = static_cast<std::size_t>(level);
    const double usable = references_[l].usable;
    Matrix10d A = pass.JtJ * (pass.weight / std::max(matrix_weight_, 1e-9));
    if (usable > 0) A.topLeftCorner<8, 8>() -= kKnownNoise * pass.weight / usable * noise_[l];
    Vector10d b = pass.Jtr;
    const double variance = std::max(1.0, pass.noise_grey * pass.noise_grey);
    for (int k = 2; k < 8; ++k) {
      const double sigma = k < 6 ? options_.affine_sigma : options_.perspective_sigma;
      const double strange = moved_[k] / (2 * sigma);  // Cauchy: a change that the picture insists on is let through
      const double tie = variance / (sigma * sigma) / (1 + strange * strange);
      A(k, k) += tie;
      b(k) += tie * moved_[k];
    }
    for (int k = parameters; k < 8; ++k) {
      A.row(k).setZero();
      A.col(k).setZero();
      A(k, k) = 1;
      b(k) = 0;
    }
    A.diagonal() *= 1 + 1e-9;
    Eigen::LDLT<Matrix10d> ldlt(A);
    if (!(ldlt.vectorD().minCoeff() > 0)) {  // less texture than noise
      A.topLeftCorner(parameters, parameters) +=
          kKnownNoise * pass.weight / usable * noise_[l].topLeftCorner(parameters, parameters);
      ldlt.compute(A);
    }
    if (ldlt.info() != Eigen::Success || !(ldlt.vectorD().minCoeff() > 0)) return false;
    step = -ldlt.solve(b);
    return step.allFinite();
  }

  // Largest move of a corner of [-1, 1]^2 under M, in patch coordinates.
  static double corner_step(const Eigen::Matrix3d& M) {
    double largest = 0;
    for (const double x : {-1.0, 1.0})
      for (const double y : {-1.0, 1.0})
        largest = std::max(largest, ((M * Eigen::Vector3d(x, y, 1)).hnormalized() - Eigen::Vector2d(x, y)).norm());
    return largest;
  }

  void judge(const Light& light, const simd::EsmTemplate& reference, Alignment& a) const {
    a.noise_grey = pass_.noise_grey;
    a.visible = reference.usable > 0 ? pass_.weight / reference.usable : 0;
    const Correlation c = correlation(reference, light, buffers_, pass_);
    a.correlation = c.believed;
    a.correlation_all = c.all;
  }

  EsmOptions options_;
  Camera camera_;
  std::vector<Patch> patches_;
  std::vector<simd::EsmTemplate> references_;  // of each patch
  std::vector<Matrix8d> noise_;  // gradient_noise() of each level
  std::vector<BentGrid> grids_;  // of a region that bends
  AlignmentBuffers buffers_;
  AlignmentPass pass_;
  int matrix_level_ = -1;       // of pass_.JtJ
  double matrix_weight_ = 1;    // of its pass
  double last_step_px_ = 0;     // of a corner
  Vector10d moved_ = Vector10d::Zero();  // from the start of this alignment, to first order
  double half_side_px_ = 1, start_gain_ = 1;
  bool wide_ = false;
};

}  // namespace

std::unique_ptr<PatchAligner> make_esm_aligner(const EsmOptions& options) {
  return std::make_unique<EsmAligner>(options);
}

}  // namespace heartservo::tracking
