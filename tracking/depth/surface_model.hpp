#pragma once
// A piece of curved tissue seen in a first frame, its pose in later ones, and where its points then appear. Lengths in
// units of the distance of its centre in the first frame: what a picture alone can know.
#include <Eigen/Geometry>
#include <vector>

namespace heartservo::tracking {

/// dz/dx, dz/dy, d2z/dx2, d2z/dxdy, d2z/dy2 of the surface at its centre in the first frame (camera frame).
using SurfaceShape = Eigen::Matrix<double, 5, 1>;

/// Position of the centre and rotation since the first frame.
struct SurfacePose {
  Eigen::Vector3d position = Eigen::Vector3d::UnitZ();
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
};

/// Moved by the small twist (v, w): position + v, exp(w) rotation.
SurfacePose moved(const SurfacePose& pose, const Eigen::Matrix<double, 6, 1>& twist);

class SurfaceModel {
 public:
  /// `rays`: where the points appear in the first frame, normalised plane; `centre`: the same of the region's centre.
  SurfaceModel(std::vector<Eigen::Vector2d> rays, const Eigen::Vector2d& centre);

  /// From the centre to point i, first frame: on its ray, on z = 1 + slope . d + d' C d / 2, d = (x, y) - centre.
  Eigen::Vector3d point(const SurfaceShape& shape, std::size_t i) const;

  /// Where the points appear: normalised x0, y0, x1, ... `J_pose` (2N x 6) and `J_shape` (2N x 5): derivatives by the
  /// twist and the shape. False where a point lies behind the camera.
  bool view(const SurfacePose& pose, const SurfaceShape& shape, Eigen::VectorXd& seen, Eigen::MatrixXd& J_pose,
            Eigen::MatrixXd& J_shape) const;

  const std::vector<Eigen::Vector2d>& rays() const { return rays_; }
  const Eigen::Vector2d& centre() const { return centre_; }

 private:
  double depth(const SurfaceShape& shape, std::size_t i) const;

  std::vector<Eigen::Vector2d> rays_;
  Eigen::Vector2d centre_;
};

}  // namespace heartservo::tracking
