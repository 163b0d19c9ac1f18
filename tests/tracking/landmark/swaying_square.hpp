#pragma once
// A square that sways about a tilt, and how often its pose lies on the wrong side of the planar ambiguity.
#include "tests/support/table2_camera.hpp"
#include "tests/tracking/landmark/square_scene.hpp"
#include "tracking/landmark/landmark_estimator.hpp"

namespace heartservo::test {

struct WrongSide {
  int with_motion = 0, without = 0, frames = 0;
};

/// `sequences` of 250 frames at 125 Hz; 4 degrees and 3 mm of sway at 5 Hz about a pose of the given tilt (rad). Counts
/// the frames whose pose is nearer to the other solution than the truth allows, with the frames before and alone.
inline WrongSide count_wrong_side(std::mt19937_64& random, double tilt, double sigma_px, int sequences) {
  using namespace tracking;
  const Camera camera = table2_camera();
  WrongSide wrong;
  for (int sequence = 0; sequence < sequences; ++sequence) {
    const auto middle = tilted_pose(random, tilt, 0.055);
    LandmarkEstimator following(camera, SIDE, "refined", sigma_px);
    for (int k = 0; k < 250; ++k) {
      const double beat = std::sin(2 * M_PI * 5 * k / 125);
      Eigen::Isometry3d truth = middle;
      truth.translation() += beat * Eigen::Vector3d(0.001, -0.001, 0.003);
      truth.linear() = Eigen::AngleAxisd(4 * M_PI / 180 * beat, Eigen::Vector3d(0.6, 0.8, 0)) * middle.linear();
      Track track;
      track.time_s = k / 125.0;
      track.state = TrackState::OK;
      track.corners = with_noise(random, project_square(camera, truth, SIDE), sigma_px);
      const auto on_wrong_side = [&](LandmarkEstimator& estimator) {
        estimator.estimate(track);
        const RefinedPose& pose = estimator.last_refined();
        const auto angle = [&](int i) {
          const auto& T = pose.solutions[i].T_camera_target;
          return Eigen::AngleAxisd(Eigen::Matrix3d(T.linear().transpose() * truth.linear())).angle();
        };
        return angle(1 - pose.taken) < angle(pose.taken) - M_PI / 180;
      };
      LandmarkEstimator fresh(camera, SIDE, "refined", sigma_px);
      wrong.with_motion += on_wrong_side(following);
      wrong.without += on_wrong_side(fresh);
      ++wrong.frames;
    }
  }
  return wrong;
}

}  // namespace heartservo::test
