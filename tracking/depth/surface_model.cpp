#include "tracking/depth/surface_model.hpp"

#include <cmath>

namespace heartservo::tracking {

namespace {

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

// d z / d shape at the offset (x, y) from the centre.
Eigen::Matrix<double, 1, 5> by_shape(const Eigen::Vector2d& d) {
  Eigen::Matrix<double, 1, 5> J;
  J << d.x(), d.y(), 0.5 * d.x() * d.x(), d.x() * d.y(), 0.5 * d.y() * d.y();
  return J;
}

}  // namespace

SurfacePose moved(const SurfacePose& pose, const Eigen::Matrix<double, 6, 1>& twist) {
  const Eigen::Vector3d w = twist.tail<3>();
  const double angle = w.norm();
  const Eigen::Matrix3d turn = angle < 1e-12 ? Eigen::Matrix3d(Eigen::Matrix3d::Identity() + cross_matrix(w))
                                             : Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
  return {pose.position + twist.head<3>(), turn * pose.rotation};
}

SurfaceModel::SurfaceModel(std::vector<Eigen::Vector2d> rays, const Eigen::Vector2d& centre)
    : rays_(std::move(rays)), centre_(centre) {}

// Where the ray meets the surface, by Newton's method on f(z) = 1 + shape(z ray - centre) - z from the tangent plane.
double SurfaceModel::depth(const SurfaceShape& shape, std::size_t i) const {
  double z = 1;
  for (int k = 0; k < 6; ++k) {
    const Eigen::Vector2d d = z * rays_[i] - centre_;
    const Eigen::Vector2d slope(shape[0] + shape[2] * d.x() + shape[3] * d.y(),
                                shape[1] + shape[3] * d.x() + shape[4] * d.y());
    const double step = (1 + (by_shape(d) * shape)(0) - z) / (1 - slope.dot(rays_[i]));
    z += step;
    if (std::abs(step) < 1e-13) break;
  }
  return z;
}

Eigen::Vector3d SurfaceModel::point(const SurfaceShape& shape, std::size_t i) const {
  return depth(shape, i) * rays_[i].homogeneous() - centre_.homogeneous();
}

bool SurfaceModel::view(const SurfacePose& pose, const SurfaceShape& shape, Eigen::VectorXd& seen,
                        Eigen::MatrixXd& J_pose, Eigen::MatrixXd& J_shape) const {
  for (std::size_t i = 0; i < rays_.size(); ++i) {
    const Eigen::Vector3d p = point(shape, i), turned = pose.rotation * p, q = pose.position + turned;
    if (!(q.z() > 1e-3)) return false;
    const auto row = 2 * static_cast<Eigen::Index>(i);
    seen.segment<2>(row) = q.hnormalized();
    Eigen::Matrix<double, 2, 3> P;
    P << 1 / q.z(), 0, -q.x() / (q.z() * q.z()), 0, 1 / q.z(), -q.y() / (q.z() * q.z());
    J_pose.block<2, 3>(row, 0) = P;
    J_pose.block<2, 3>(row, 3) = -P * cross_matrix(turned);
    // the implicit function: dz/dshape = by_shape / (1 - slope . ray)
    const Eigen::Vector2d d = p.head<2>();
    const Eigen::Vector2d slope(shape[0] + shape[2] * d.x() + shape[3] * d.y(),
                                shape[1] + shape[3] * d.x() + shape[4] * d.y());
    J_shape.middleRows<2>(row) =
        P * pose.rotation * rays_[i].homogeneous() * (by_shape(d) / (1 - slope.dot(rays_[i])));
  }
  return true;
}

}  // namespace heartservo::tracking
