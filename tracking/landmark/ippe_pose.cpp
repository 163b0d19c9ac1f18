#include "tracking/landmark/ippe_pose.hpp"

#include <opencv2/calib3d.hpp>
#include <vector>

namespace heartservo::tracking {

bool ippe_square_poses(const std::array<Eigen::Vector2d, 4>& normalised_corners, double side_m,
                       std::array<Eigen::Isometry3d, 2>& T_camera_target) {
  // OpenCV fixes the order to ours (from top left clockwise), but on a plane with y up and z towards the camera. A
  // square of side 1 keeps its absolute thresholds out of the play of units.
  const std::vector<cv::Point3d> square{{-0.5, 0.5, 0}, {0.5, 0.5, 0}, {0.5, -0.5, 0}, {-0.5, -0.5, 0}};
  std::vector<cv::Point2d> points;
  for (const auto& corner : normalised_corners) {
    if (!corner.allFinite()) return false;
    points.emplace_back(corner.x(), corner.y());
  }
  std::vector<cv::Vec3d> rotations, translations;
  try {
    cv::solvePnPGeneric(square, points, cv::Matx33d::eye(), cv::noArray(), rotations, translations, false,
                        cv::SOLVEPNP_IPPE_SQUARE);
  } catch (const cv::Exception&) {  // corners it cannot work with are no pose, not an error
    return false;
  }
  if (rotations.size() != 2 || translations.size() != 2) return false;
  for (int i = 0; i < 2; ++i) {
    const Eigen::Vector3d w(rotations[i][0], rotations[i][1], rotations[i][2]);
    const Eigen::Vector3d t(translations[i][0], translations[i][1], translations[i][2]);
    if (!w.allFinite() || !t.allFinite()) return false;
    Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
    if (w.norm() > 0) R = Eigen::AngleAxisd(w.norm(), w.normalized());
    T_camera_target[i].setIdentity();
    T_camera_target[i].linear() = R * Eigen::Vector3d(1, -1, -1).asDiagonal();
    T_camera_target[i].translation() = side_m * t;
  }
  return true;
}

}  // namespace heartservo::tracking
