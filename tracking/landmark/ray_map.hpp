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
    float* point = &points_[2 * (static_cast<std::size_t>(v) * camera_.width + u)];
    if (point[0] == std::numeric_limits<float>::infinity()) {
      const Eigen::Vector2d normalised = camera_.normalise({u, v});  // NaN outside the model
      point[0] = static_cast<float>(normalised.x()), point[1] = static_cast<float>(normalised.y());
    }
    return {point[0], point[1], 1};
  }

 private:
  Camera camera_;
  std::vector<float> points_;
};

}  // namespace heartservo::tracking
