#include "tracking/planar/template_judge.hpp"

#include <algorithm>
#include <cmath>

namespace heartservo::tracking {

namespace {

constexpr int kSmallestSide = 9;        // points; a coarser template says nothing
constexpr double kSmallestShare = 0.3;  // of the template's points must be in the picture
constexpr int kRounds = 2;              // of least squares and weights: the second without what the first left out

}  // namespace

void TemplateJudge::learn(const ImagePyramid& picture, const Camera& camera, const Eigen::Matrix3d& G, int side_x,
                          int side_y) {
  camera_ = camera;
  patches_.clear();
  references_.clear();
  for (int level = 0; level < picture.levels(); ++level) {
    const int width = (side_x >> level) + 1, height = (side_y >> level) + 1;
    if (level > 0 && std::min(width, height) < kSmallestSide) break;
    patches_.push_back(make_patch(picture.level(level), camera, G, width, height));
    references_.emplace_back(patches_.back());
  }
  half_side_px_ = 0.5 * std::max(side_x, side_y);
  buffers_.resize(patches_.front().size());
}

const Patch& TemplateJudge::patch(int level) const {
  return patches_[static_cast<std::size_t>(std::min(level, levels() - 1))];
}

void TemplateJudge::sample(const ImagePyramid& picture, const Eigen::Matrix3d& G) {
  warp(picture.level(0), camera_, G, patches_.front(), Interpolation::CUBIC, buffers_.grey.data(), nullptr);
}

void TemplateJudge::judge(const ImagePyramid& picture, Alignment& a) {
  a.converged = false;
  a.correlation = a.correlation_all = a.visible = a.noise_grey = 0;
  if (!a.G_plane_patch.allFinite()) return;
  sample(picture, a.G_plane_patch);
  const simd::EsmTemplate& reference = references_.front();
  const double usable = reference.usable;
  Light light;
  AlignmentPass pass;
  for (int round = 0; round < kRounds; ++round) {
    if (!fit_light(reference, buffers_, round > 0 ? &pass : nullptr, light)) return;
    weigh_points(reference, light, buffers_, pass);
    if (!(pass.points >= kSmallestShare * usable)) return;
  }
  a.gain = light.gain, a.bias = light.bias;
  a.noise_grey = pass.noise_grey;
  a.visible = usable > 0 ? pass.weight / usable : 0;
  const Correlation c = correlation(reference, light, buffers_, pass);
  a.correlation = c.believed;
  a.correlation_all = c.all;
  a.converged = true;
}

double TemplateJudge::correlation_at(const ImagePyramid& picture, const Eigen::Matrix3d& G) {
  if (!G.allFinite()) return 0;
  sample(picture, G);
  const simd::EsmTemplate& reference = references_.front();
  AlignmentPass pass;
  weigh_points(reference, {}, buffers_, pass);
  return pass.points >= kSmallestShare * reference.usable ? correlation(reference, {}, buffers_, pass).all : 0;
}

}  // namespace heartservo::tracking
