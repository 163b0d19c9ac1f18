#pragma once
// The endoscope's camera: the paper's model, eq. 1-4 (pinhole, two radial and two tangential terms; the same as
// OpenCV's k1 k2 p1 p2).
//
// Vocabulary: a point in the camera frame (m; x right, y down, z forward); its *normalised* point (xn, yn) on the plane
// Z = 1, free of distortion; its *distorted* normalised point (xd, yd); its *pixel* (u, v), where (0, 0) is the
// centre of the top-left pixel.
#include <Eigen/Core>
#include <string>
#include <vector>

namespace heartservo::tracking {

struct Camera {
  int width = 0;   ///< px
  int height = 0;  ///< px
  double fx = 0;   ///< focal length in px (the paper's fc1)
  double fy = 0;   ///< focal length in px (fc2)
  double cx = 0;   ///< principal point in px (u0)
  double cy = 0;   ///< principal point in px (v0)
  double k1 = 0;   ///< radial, r^2
  double k2 = 0;   ///< radial, r^4
  double k3 = 0;   ///< tangential, OpenCV's p1
  double k4 = 0;   ///< tangential, OpenCV's p2

  /// Eq. 3 and 4: normalised point -> distorted normalised point.
  Eigen::Vector2d distort(const Eigen::Vector2d& normalised) const;

  /// d distort / d normalised (2 x 2).
  Eigen::Matrix2d distort_jacobian(const Eigen::Vector2d& normalised) const;

  /// Inverse of distort() by Newton's method, to 1e-12 on the normalised plane. NaN where the model cannot be
  /// inverted (far outside the picture, where the polynomial folds).
  Eigen::Vector2d undistort(const Eigen::Vector2d& distorted) const;

  /// Eq. 2: distorted normalised point <-> pixel.
  Eigen::Vector2d to_pixel(const Eigen::Vector2d& distorted) const {
    return {fx * distorted.x() + cx, fy * distorted.y() + cy};
  }
  Eigen::Vector2d from_pixel(const Eigen::Vector2d& pixel) const {
    return {(pixel.x() - cx) / fx, (pixel.y() - cy) / fy};
  }

  /// Eq. 1-4: point in the camera frame (m, z > 0) -> pixel.
  Eigen::Vector2d project(const Eigen::Vector3d& point) const {
    return to_pixel(distort(Eigen::Vector2d(point.x() / point.z(), point.y() / point.z())));
  }

  /// Pixel -> undistorted normalised point.
  Eigen::Vector2d normalise(const Eigen::Vector2d& pixel) const { return undistort(from_pixel(pixel)); }

  bool has_distortion() const { return k1 != 0 || k2 != 0 || k3 != 0 || k4 != 0; }

  /// Every problem at once, empty when the camera is usable: sizes and focal lengths positive, all finite, principal
  /// point near the picture, distortion invertible over the whole picture.
  std::vector<std::string> validate() const;

  /// A pinhole camera with the given horizontal field of view (rad), principal point in the centre.
  static Camera pinhole(int width, int height, double horizontal_field_of_view);
};

}  // namespace heartservo::tracking
