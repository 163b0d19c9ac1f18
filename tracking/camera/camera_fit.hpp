#pragma once
// The nearest camera that has fewer terms.
#include "tracking/camera/wide_camera.hpp"

namespace heartservo::tracking {

/// Terms a camera may have beside fx, fy, cx, cy, k1.
struct CameraTerms {
  bool k2 = false, tangential = false, k5 = false, skew = false;
};

/// eq. 1-4.
inline constexpr CameraTerms PAPER_TERMS{true, true, false, false};

/// Differences in px between pictures of the same rays, on a grid over the picture.
struct PictureError {
  double rms_px = 0, max_px = 0;
  Eigen::Vector2d worst_px = Eigen::Vector2d::Zero();  ///< where the largest is
};

struct CameraFit {
  WideCamera camera;
  PictureError error;             ///< zero where nothing had to be left out
  std::vector<std::string> lost;  ///< the terms left out: "k2", "k3", "k4", "k5", "skew"
};

/// The camera with only `terms` that sees the same rays at the same pixels, by least squares over the picture. `from`
/// must be valid. Where `from` has no other terms it comes back as it is.
CameraFit fit_camera(const WideCamera& from, const CameraTerms& terms);

/// ViSP's way back, pixel to metre: (xn, yn) = (1 + kdu rd^2)(xd, yd) with (xd, yd) by the focal lengths and the
/// principal point of `visp`; kdu by least squares over the picture, so that the rays are those of `from`.
struct BackwardFit {
  double kdu = 0;
  PictureError error;  ///< of the rays, times the focal lengths
};
BackwardFit fit_backward(const Camera& visp, const WideCamera& from);

}  // namespace heartservo::tracking
