#include "tracking/planar/ssd_aligner.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "tracking/planar/quad.hpp"
#include "tracking/planar/sl3.hpp"
#include "tracking/planar/template_judge.hpp"

namespace heartservo::tracking {

namespace {

constexpr double kNear_px = 0.05;       // a coarse level need not come nearer
constexpr double kSmallestShare = 0.3;  // of the template's points must be in the picture

using Matrix8d = Eigen::Matrix<double, 8, 8>;

struct NormalEquations {
  Matrix8d JtJ = Matrix8d::Zero();
  Vector8d Jtr = Vector8d::Zero();
  double points = 0;
};

class SsdAligner final : public PatchAligner {
 public:
  explicit SsdAligner(const SsdOptions& options) : options_(options) {}

  void learn(const ImagePyramid& picture, const Camera& camera, const Eigen::Matrix3d& G, int side_x,
             int side_y) override {
    judge_.learn(picture, camera, G, side_x, side_y);
    grey_.resize(judge_.patch(0).size());
    inside_.resize(grey_.size());
    rows_.resize(Eigen::NoChange, judge_.patch(0).width);
  }

  const Patch& patch(int level) const override { return judge_.patch(level); }

  Alignment align(const ImagePyramid& picture, const Alignment& start, int coarsest, MotionModel model) override {
    Alignment a = start;
    a.iterations = 0;
    a.converged = false;
    for (int level = std::min({coarsest, picture.levels() - 1, judge_.levels() - 1}); level >= 0; --level)
      if (!align_level(picture.level(level), level, level == 0 ? model : MotionModel::AFFINE, a)) return a;
    judge_.judge(picture, a);
    return a;
  }

 private:
  bool align_level(const PyramidLevel& picture, int level, MotionModel model, Alignment& a) {
    const Patch& patch = judge_.patch(level);
    const double enough_px = level == 0 ? options_.step_px : kNear_px * (1 << level);
    bool done = false;
    for (int i = 0; i < options_.max_iterations && !done; ++i, ++a.iterations) {
      if (!a.G_plane_patch.allFinite()) return false;
      warp(picture, judge_.camera(), a.G_plane_patch, patch, Interpolation::CUBIC, grey_.data(), inside_.data());
      const NormalEquations normal = accumulate(patch);
      if (normal.points < kSmallestShare * judge_.usable(level)) return false;
      const int n = static_cast<int>(model);
      const Eigen::LDLT<Eigen::MatrixXd> ldlt(normal.JtJ.topLeftCorner(n, n));
      if (ldlt.info() != Eigen::Success || !(ldlt.vectorD().minCoeff() > 0)) return false;
      Vector8d step = Vector8d::Zero();
      step.head(n) = -ldlt.solve(normal.Jtr.head(n));
      if (!step.allFinite()) return false;
      const Eigen::Matrix3d M = sl3_exp(step);
      a.G_plane_patch = to_sl3(a.G_plane_patch * M);
      done = corner_step(M) * judge_.half_side_px() < enough_px;
    }
    return a.G_plane_patch.allFinite();
  }

  // Jacobian and residual of every usable point: gradient of the warped picture by central differences on the grid.
  NormalEquations accumulate(const Patch& patch) {
    NormalEquations normal;
    Eigen::Matrix<float, 9, 9> products;
    const int width = patch.width;
    for (int row = 1; row + 1 < patch.height; ++row) {
      const float y = patch.y_of(row), half = 0.5F / patch.step;
      for (int column = 1; column + 1 < width; ++column) {
        const std::size_t i = static_cast<std::size_t>(row * width + column);
        const float* g = &grey_[i];
        const float w = patch.usable[i] * inside_[i], x = patch.x_of(column);
        const float gx = w * half * (g[1] - g[-1]), gy = w * half * (g[width] - g[-width]);
        const float radial = gx * x + gy * y;
        rows_.col(column - 1) << gx, gy, gx * y, gy * x, gx * x - gy * y, radial, -x * radial, -y * radial,
            w * (g[0] - patch.grey[i]);
        normal.points += static_cast<double>(w);
      }
      const auto filled = rows_.leftCols(width - 2);
      products.noalias() = filled.lazyProduct(filled.transpose());
      normal.JtJ += products.topLeftCorner<8, 8>().cast<double>();
      normal.Jtr += products.topRightCorner<8, 1>().cast<double>();
    }
    return normal;
  }

  // Largest move of a corner of [-1, 1]^2 under M, in patch coordinates.
  static double corner_step(const Eigen::Matrix3d& M) {
    double largest = 0;
    for (const auto& c : rectangle(-1, -1, 2, 2))
      largest = std::max(largest, ((M * c.homogeneous()).hnormalized() - c).norm());
    return largest;
  }

  SsdOptions options_;
  TemplateJudge judge_;
  std::vector<float> grey_, inside_;
  Eigen::Matrix<float, 9, Eigen::Dynamic> rows_;  // J and residual of one row of the template
};

}  // namespace

std::unique_ptr<PatchAligner> make_ssd_aligner(const SsdOptions& options) {
  return std::make_unique<SsdAligner>(options);
}

}  // namespace heartservo::tracking
