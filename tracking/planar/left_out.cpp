#include "tracking/planar/left_out.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "tracking/planar/normal_equations.hpp"

namespace heartservo::tracking {

namespace {

// Bilinear grey value; NaN outside the window of the picture.
double grey_at(const PyramidLevel& picture, const Eigen::Vector2d& at) {
  const Eigen::Vector2d p = at - Eigen::Vector2d(picture.u0, picture.v0);
  if (!(p.x() >= 0 && p.y() >= 0 && p.x() < picture.bytes.cols - 1 && p.y() < picture.bytes.rows - 1)) return NAN;
  const int u = static_cast<int>(p.x()), v = static_cast<int>(p.y());
  const double a = p.x() - u, b = p.y() - v;
  const auto grey = [&](int du, int dv) { return static_cast<double>(picture.bytes.at<std::uint8_t>(v + dv, u + du)); };
  return (1 - b) * ((1 - a) * grey(0, 0) + a * grey(1, 0)) + b * ((1 - a) * grey(0, 1) + a * grey(1, 1));
}

}  // namespace

void mark_left_out(const PyramidLevel& picture, const Camera& camera, const PatchAligner& aligner, const Alignment& a,
                   cv::Mat& mask) {
  const Patch& patch = aligner.patch(0);
  const double strange = kTukey * std::max(kSmallestNoise, a.noise_grey);
  for (int row = 1; row + 1 < patch.height; ++row)
    for (int column = 1; column + 1 < patch.width; ++column) {
      const auto i = static_cast<std::size_t>(row * patch.width + column);
      const Eigen::Vector2d point(patch.x_of(column), patch.y_of(row));
      const Eigen::Vector3d plane = a.G_plane_patch * aligner.bent(a, point).homogeneous();
      const Eigen::Vector2d at = camera.to_pixel(camera.distort(plane.hnormalized()));
      const double grey = grey_at(picture, at);
      if (std::isnan(grey)) continue;
      const double residual = aligner.gain_at(a, point) * grey + a.bias - static_cast<double>(patch.grey[i]);
      if (patch.usable[i] > 0 && grey < static_cast<double>(kSaturatedGrey) && std::abs(residual) < strange) continue;
      const int u = static_cast<int>(at.x()), v = static_cast<int>(at.y());
      // two by two, so that a region seen larger than it was learnt shows no holes
      mask(cv::Rect(u, v, 2, 2) & cv::Rect(0, 0, mask.cols, mask.rows)).setTo(255);
    }
}

}  // namespace heartservo::tracking
