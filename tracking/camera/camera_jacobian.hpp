#pragma once
// Derivatives of eq. 1-4, and the eight parameters as a vector.
#include <Eigen/Core>

#include "tracking/camera/camera.hpp"

namespace heartservo::tracking {

/// fx, fy, cx, cy (px), k1, k2, k3, k4.
using CameraParameters = Eigen::Matrix<double, 8, 1>;
inline constexpr const char* CAMERA_PARAMETER_NAMES[8] = {"fx", "fy", "cx", "cy", "k1", "k2", "k3", "k4"};

CameraParameters parameters_of(const Camera& camera);

/// `camera` with other parameters; the size stays.
Camera with_parameters(const Camera& camera, const CameraParameters& parameters);

/// d pixel / d parameters at an undistorted normalised point.
Eigen::Matrix<double, 2, 8> parameter_jacobian(const Camera& camera, const Eigen::Vector2d& normalised);

/// d pixel / d point, for a point in the camera frame (m, z > 0).
Eigen::Matrix<double, 2, 3> projection_jacobian(const Camera& camera, const Eigen::Vector3d& point);

}  // namespace heartservo::tracking
