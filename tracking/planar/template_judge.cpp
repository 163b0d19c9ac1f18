#include "tracking/planar/template_judge.hpp"

#include <algorithm>
#include <cmath>

namespace heartservo::tracking {

namespace {

constexpr int kSmallestSide = 9;        // points; a coarser template says nothing
constexpr double kSmallestShare = 0.3;  // of the template's points must be in the picture
constexpr int kRounds = 2;              // of least squares and weights: the second without what the first left out

// Gain and bias that bring the picture nearest to the template under the weights; false where the picture is plain.
bool fit_illumination(const Patch& patch, const AlignmentBuffers& b, double& gain, double& bias) {
  double w = 0, p = 0, t = 0, pp = 0, pt = 0;
  for (std::size_t i = 0; i < patch.size(); ++i) {
    const double weight = static_cast<double>(b.weight[i]);
    const double x = static_cast<double>(b.grey[i]), y = static_cast<double>(patch.grey[i]);
    w += weight, p += weight * x, t += weight * y, pp += weight * x * x, pt += weight * x * y;
  }
  const double variance = pp - p * p / w;
  if (!(w > 0) || !(variance > 1e-3 * w)) return false;
  gain = (pt - p * t / w) / variance;
  bias = (t - gain * p) / w;
  return std::isfinite(gain) && std::isfinite(bias);
}

}  // namespace

void TemplateJudge::learn(const ImagePyramid& picture, const Camera& camera, const Eigen::Matrix3d& G, int side_x,
                          int side_y) {
  camera_ = camera;
  patches_.clear();
  usable_.clear();
  for (int level = 0; level < picture.levels(); ++level) {
    const int width = (side_x >> level) + 1, height = (side_y >> level) + 1;
    if (level > 0 && std::min(width, height) < kSmallestSide) break;
    patches_.push_back(make_patch(picture.level(level), camera, G, width, height));
    double usable = 0;
    for (const float u : patches_.back().usable) usable += static_cast<double>(u);
    usable_.push_back(usable);
  }
  half_side_px_ = 0.5 * std::max(side_x, side_y);
  buffers_.resize(patches_.front().size());
}

const Patch& TemplateJudge::patch(int level) const {
  return patches_[static_cast<std::size_t>(std::min(level, levels() - 1))];
}

// Samples the picture; every believable point gets weight 1. Returns how many there are.
double TemplateJudge::sample(const ImagePyramid& picture, const Eigen::Matrix3d& G) {
  const Patch& patch = patches_.front();
  warp(picture.level(0), camera_, G, patch, Interpolation::CUBIC, buffers_.grey.data(), buffers_.inside.data());
  double points = 0;
  for (std::size_t i = 0; i < patch.size(); ++i) {
    buffers_.weight[i] = buffers_.grey[i] < kSaturatedGrey ? patch.usable[i] * buffers_.inside[i] : 0.0F;
    points += static_cast<double>(buffers_.weight[i]);
  }
  return points;
}

void TemplateJudge::judge(const ImagePyramid& picture, Alignment& a) {
  a.converged = false;
  a.correlation = a.correlation_all = a.visible = a.noise_grey = 0;
  if (!a.G_plane_patch.allFinite()) return;
  const double usable = usable_.front();
  if (!(sample(picture, a.G_plane_patch) >= kSmallestShare * usable)) return;
  for (int round = 0; round < kRounds; ++round) {
    if (!fit_illumination(patches_.front(), buffers_, a.gain, a.bias)) return;
    const AlignmentPass pass = esm_pass(patches_.front(), {a.gain, a.bias}, buffers_);
    a.noise_grey = pass.noise_grey;
    a.visible = usable > 0 ? pass.weight / usable : 0;
  }
  const Correlation c = correlation(patches_.front(), {a.gain, a.bias}, buffers_);
  a.correlation = c.believed;
  a.correlation_all = c.all;
  a.converged = true;
}

double TemplateJudge::correlation_at(const ImagePyramid& picture, const Eigen::Matrix3d& G) {
  if (!G.allFinite() || !(sample(picture, G) >= kSmallestShare * usable_.front())) return 0;
  return correlation(patches_.front(), {}, buffers_).believed;
}

}  // namespace heartservo::tracking
