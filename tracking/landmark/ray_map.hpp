#pragma once
#include <limits>
#include <vector>

#include "tracking/camera/camera.hpp"

namespace heartservo::tracking {

/// The undistorted normalised points of a camera's pixels, each worked out when it is first asked for.
class RayMap {
 public:
  explicit RayMap(const Camera& camera)
      : camera_(camera),
        points_(2 * static_cast<std::size_t>(camera.width) * camera.height, std::numeric_limits<float>::infinity()) {}

  /// Ray (xn, yn, 1) of the pixel (u, v), which must lie in the picture; not finite where the camera has none.
  Eigen::Vector3d at(int u, int v) {
    const float* point = row(u, v, 1);
    return {point[0], point[1], 1};
  }

  /// x and y of `n` pixels of a row from (u, v) on, one pixel after the other.
  const float* row(int u, int v, std::size_t n) {
    float* first = &points_[2 * (static_cast<std::size_t>(v) * camera_.width + u)];
    for (std::size_t i = 0; i < n; ++i)
      if (first[2 * i] == std::numeric_limits<float>::infinity()) work_out(u + static_cast<int>(i), v, first + 2 * i);
    return first;
  }

 private:
  void work_out(int u, int v, float* point) const {
    const Eigen::Vector2d normalised = camera_.normalise({u, v});  // NaN outside the model
    point[0] = static_cast<float>(normalised.x()), point[1] = static_cast<float>(normalised.y());
  }

  Camera camera_;
  std::vector<float> points_;
};

}  // namespace heartservo::tracking
