#pragma once
// What camera files can say beyond eq. 1-4: two further terms that other programs may use.
#include <Eigen/Core>
#include <string>
#include <vector>

#include "tracking/camera/camera.hpp"

namespace heartservo::tracking {

/// u = fx xd + skew yd + cx,  v = fy yd + cy,  (xd, yd) = (1 + k1 r^2 + k2 r^4 + k5 r^6)(xn, yn) + dx of eq. 4.
struct WideCamera {
  Camera camera;
  double k5 = 0;    ///< radial, r^6 (OpenCV's k3, Bouguet's kc(5))
  double skew = 0;  ///< px (Bouguet's alpha_c times fx)

  /// Undistorted normalised point -> pixel.
  Eigen::Vector2d to_pixel(const Eigen::Vector2d& normalised) const;

  /// Pixel -> undistorted normalised point; NaN where the model cannot be inverted.
  Eigen::Vector2d normalise(const Eigen::Vector2d& pixel) const;

  /// True when eq. 1-4 say it all.
  bool is_paper_model() const { return k5 == 0 && skew == 0; }

  /// As Camera::validate(), with the further terms.
  std::vector<std::string> validate() const;
};

/// Points of a grid over the picture, rim included (px; `steps` + 1 in each direction).
std::vector<Eigen::Vector2d> picture_grid(int width, int height, int steps = 32);

}  // namespace heartservo::tracking
