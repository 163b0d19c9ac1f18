#pragma once
#include <Eigen/Core>
#include <array>

namespace heartservo::tracking {

/// Four corners in pixels, clockwise from top left.
using Quad = std::array<Eigen::Vector2d, 4>;

inline Eigen::Vector2d centre(const Quad& q) { return (q[0] + q[1] + q[2] + q[3]) / 4; }

inline Quad rectangle(double x, double y, double width, double height) {
  return {Eigen::Vector2d(x, y), Eigen::Vector2d(x + width, y), Eigen::Vector2d(x + width, y + height),
          Eigen::Vector2d(x, y + height)};
}

/// Signed area in px^2, positive for clockwise corners in picture coordinates (y down).
double area(const Quad& quad);

/// True when the corners are finite, clockwise and convex.
bool is_convex(const Quad& quad);

/// The homography (lower right element 1) that takes from[i] to to[i].
Eigen::Matrix3d homography_between(const Quad& from, const Quad& to);

/// The quad's corners moved by H.
Quad transform(const Eigen::Matrix3d& H, const Quad& quad);

/// How a quad differs from the reference it is a view of.
struct ViewChange {
  double scale = 1;        ///< sqrt of the ratio of areas
  double anisotropy = 1;   ///< ratio of the stretches along the two principal directions, >= 1
  double perspective = 1;  ///< largest ratio of opposite sides, each against the reference's, >= 1
};
ViewChange view_change(const Quad& reference, const Quad& current);

}  // namespace heartservo::tracking
