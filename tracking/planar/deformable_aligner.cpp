#include "tracking/planar/deformable_aligner.hpp"

#include <cmath>

#include "tracking/planar/band_cholesky.hpp"
#include "tracking/planar/bend_equations.hpp"
#include "tracking/planar/esm_aligner.hpp"
#include "tracking/planar/sl3.hpp"

namespace heartservo::tracking {

namespace {

constexpr double kWorthBending = 0.4;   // correlation of the homography; below it is another place
constexpr double kSmallestShare = 0.3;  // of the template's points must be in the picture

class DeformableAligner final : public PatchAligner {
 public:
  explicit DeformableAligner(const DeformableOptions& options) : options_(options) {
    EsmOptions esm;
    esm.max_iterations = options.max_iterations;
    esm.cell_px = options.cell_px;
    homography_ = make_esm_aligner(esm);
  }

  void learn(const ImagePyramid& picture, const Camera& camera, const Eigen::Matrix3d& G, int side_x,
             int side_y) override {
    camera_ = camera;
    homography_->learn(picture, camera, G, side_x, side_y);
    const Patch& patch = homography_->patch(0);
    grid_.emplace(bend_of(side_x, side_y, options_.cell_px), patch);
    half_side_px_ = 0.5 * std::max(side_x, side_y);
    reference_ = simd::EsmTemplate(patch);
    usable_ = reference_.usable;
    buffers_.resize(patch.size());
    equations_.resize(points());
    differences_ = grid_->spline().differences();
    step_.resize(equations_.Jtr.size());
    band_ = band_of(grid_->spline());
  }

  const Patch& patch(int level) const override { return homography_->patch(level); }

  bool obeys_model() const override { return false; }

  Eigen::Vector2d bent(const Alignment& a, const Eigen::Vector2d& point) const override {
    return a.bend.cols() > 0 ? point + grid_->spline().offset(a.bend, point) : point;
  }

  double gain_at(const Alignment& a, const Eigen::Vector2d& point) const override {
    return a.bend.cols() > 0 ? a.gain + grid_->spline().gain_offset(a.bend, point) : a.gain;
  }

  Alignment align(const ImagePyramid& picture, const Alignment& start, int coarsest, MotionModel) override {
    Alignment a = homography_->align(picture, start, coarsest, MotionModel::AFFINE);
    if (!a.converged || a.correlation < kWorthBending) return a;
    if (a.bend.cols() == 0) a.bend.setZero(3, points());
    a.converged = bend(picture.level(0), start, a);
    return a;
  }

 private:
  int points() const { return grid_->spline().points(); }

  bool bend(const PyramidLevel& picture, const Alignment& start, Alignment& a) {
    const Patch& patch = homography_->patch(0);
    before_ = a.bend;
    for (int i = 0; i < options_.bend_iterations; ++i) {
      ++a.iterations;
      const BentPoints bent = grid_->bend(a.bend);
      warp(picture, camera_, a.G_plane_patch, patch, Interpolation::CUBIC, buffers_.grey.data(), nullptr, bent);
      const Light light{a.gain, a.bias, bent.gain_offset};
      AlignmentPass pass;
      weigh_points(reference_, light, buffers_, pass);
      if (pass.points < kSmallestShare * usable_) return false;
      equations_.clear(band_);
      add_bend_pass(patch, light, *grid_, buffers_, equations_);
      add_prior(std::max(1.0, pass.noise_grey * pass.noise_grey), a);
      const double mean_of_greys = mean_grey();
      step_ = equations_.Jtr;
      if (!solve_banded(equations_.JtJ, band_, step_) || !step_.allFinite()) return false;
      const Eigen::Map<const Eigen::Matrix3Xd> moves(step_.data(), 3, points());
      a.bend -= moves;
      a.bias -= step_(3 * points());
      // the mean gain goes where every aligner has it; what it may not do to the mean grey, the bias has to
      const double mean = a.bend.row(2).mean(), wanted_gain = a.gain + mean;
      a.bend.row(2).array() -= mean;
      a.gain =
          std::clamp(wanted_gain, start.gain / (1 + options_.gain_change), start.gain * (1 + options_.gain_change));
      a.bias += (wanted_gain - a.gain) * mean_of_greys;
      const bool last = moves.topRows<2>().cwiseAbs().maxCoeff() * half_side_px_ < options_.step_px;
      if (last || i + 1 == options_.bend_iterations) judge(pass, light, a);
      if (last) break;
    }
    a.G_plane_patch = to_sl3(a.G_plane_patch * grid_->spline().split_homography(a.bend));
    return a.G_plane_patch.allFinite() && a.bend.allFinite();
  }

  // Smooth bending and shading, near to that of the frame before; a maximum a posteriori estimate with the given noise
  // variance. Second differences have a Cauchy distribution: most of the region is smooth, a fold may be sharp.
  void add_prior(double variance, const Alignment& a) {
    const double per_px2 = variance * half_side_px_ * half_side_px_;
    const double bend_weight = per_px2 / (options_.bend_sigma_px * options_.bend_sigma_px);
    const double shade_weight = variance / (options_.shade_sigma * options_.shade_sigma);
    const double fold_px = 2 * options_.bend_sigma_px / half_side_px_;
    for (const auto& d : differences_) {
      Eigen::Vector3d value = Eigen::Vector3d::Zero();
      for (std::size_t i = 0; i < 4; ++i) value += d.factor[i] * a.bend.col(d.point[i]);
      const double bend = bend_weight / (1 + value.head<2>().squaredNorm() / (fold_px * fold_px));
      for (int part = 0; part < 3; ++part) add_difference(d, part, part < 2 ? bend : shade_weight, value[part]);
    }
    const double change_weight = per_px2 / (options_.change_sigma_px * options_.change_sigma_px);
    const double light_weight = variance / (options_.gain_change * options_.gain_change);
    for (int i = 0; i < points(); ++i)
      for (int part = 0; part < 3; ++part) {
        const double weight = part < 2 ? change_weight : light_weight;
        equations_.JtJ(3 * i + part, 3 * i + part) += weight;
        equations_.Jtr(3 * i + part) += weight * (a.bend(part, i) - before_(part, i));
      }
  }

  // Weighted mean of the picture's grey values: the splines of the gain add up to 1 everywhere.
  double mean_grey() const {
    const int bias = 3 * points();
    double sum = 0;
    for (int i = 0; i < points(); ++i) sum += equations_.JtJ(bias, 3 * i + 2);
    return equations_.JtJ(bias, bias) > 0 ? sum / equations_.JtJ(bias, bias) : 0;
  }

  void add_difference(const SplineBend::Difference& d, int part, double weight, double value) {
    for (std::size_t i = 0; i < 4; ++i) {
      const int row = 3 * d.point[i] + part;
      equations_.Jtr(row) += weight * d.factor[i] * value;
      for (std::size_t j = 0; j < 4; ++j)
        if (const int column = 3 * d.point[j] + part; column <= row)
          equations_.JtJ(row, column) += weight * d.factor[i] * d.factor[j];
    }
  }

  void judge(const AlignmentPass& pass, const Light& light, Alignment& a) const {
    a.noise_grey = pass.noise_grey;
    a.visible = usable_ > 0 ? pass.weight / usable_ : 0;
    const Correlation c = correlation(reference_, light, buffers_, pass);
    a.correlation = c.believed;
    a.correlation_all = c.all;
  }

  DeformableOptions options_;
  std::unique_ptr<PatchAligner> homography_;
  Camera camera_;
  std::optional<BentGrid> grid_;
  simd::EsmTemplate reference_;
  AlignmentBuffers buffers_;
  BendEquations equations_;
  std::vector<SplineBend::Difference> differences_;
  int band_ = 0;
  Eigen::VectorXd step_;
  BendField before_{3, 0};
  double half_side_px_ = 1, usable_ = 0;
};

}  // namespace

std::unique_ptr<PatchAligner> make_deformable_aligner(const DeformableOptions& options) {
  return std::make_unique<DeformableAligner>(options);
}

}  // namespace heartservo::tracking
