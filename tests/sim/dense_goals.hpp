#pragma once
// The dense pose on the simulated endoscope's pictures against the truth and against the Cramer-Rao bound, over poses
// drawn in the working volume. Shared by the test and the bench (tests/bench/pose_goals.cpp).
#include <random>

#include "servo/loop/score.hpp"
#include "tests/sim/posed_landmark.hpp"
#include "tests/tracking/landmark/square_scene.hpp"
#include "tracking/frames/frame.hpp"
#include "tracking/landmark/dense_estimator.hpp"

namespace heartservo::test {

struct DenseGoals {
  int poses = 0, invalid = 0;
  servo::Spread x, y, z;           ///< estimate minus truth, m
  servo::Spread bound_z, bound_x;  ///< standard deviations by the bound, m
  Eigen::Matrix<double, 6, 1> over_bound = Eigen::Matrix<double, 6, 1>::Zero();  ///< RMS of error / bound
  double chi2_pose = 0, chi2_position = 0;  ///< normalised squared errors by the estimator's own covariance, sums
  std::vector<double> misfit_grey;          ///< of the bound's model to the renderer, per pose; glare counts
  double ms = 0;                            ///< per estimate, mean
};

/// Tilt 0 to `largest_tilt` (rad) from the line of sight, to any side; depth 45 to 65 mm. The estimator starts at corners with
/// noise of `corner_sigma_px`; every pose is new to it.
inline DenseGoals dense_goals(const tracking::Camera& camera, std::mt19937_64& random, int poses, double smallest_tilt,
                              double largest_tilt, double sigma_grey, double corner_sigma_px,
                              double (*now_s)() = nullptr) {
  const PosedLandmark landmark(camera);
  const PoseBound bound(camera);
  tracking::DenseEstimator estimator(camera, PosedLandmark::kSide_m, sim::pattern_picture(0), corner_sigma_px);
  DenseGoals goals;
  std::vector<double> x, y, z, bound_x, bound_z;
  for (int k = 0; k < poses; ++k) {
    const Eigen::Isometry3d truth =
        tilted_pose(random, uniform(random, smallest_tilt, largest_tilt), uniform(random, 0.045, 0.065));
    tracking::Frame frame;
    frame.grey = landmark.picture(truth, sigma_grey, random());
    frame.sequence = static_cast<std::uint64_t>(k);
    frame.time_s = k;  // a second apart: no pose follows from the one before
    tracking::Track track;
    track.time_s = frame.time_s, track.sequence = frame.sequence, track.state = tracking::TrackState::OK;
    track.corners =
        with_noise(random, tracking::project_square(camera, truth, PosedLandmark::kSide_m), corner_sigma_px);
    const double begin = now_s ? now_s() : 0;
    estimator.look_at(frame);
    const auto state = estimator.estimate(track);
    if (now_s) goals.ms += 1e3 * (now_s() - begin) / poses;
    goals.invalid += !estimator.last_dense().valid;

    const Eigen::AngleAxisd turn(Eigen::Matrix3d(state.T_camera_target.linear() * truth.linear().transpose()));
    Eigen::Matrix<double, 6, 1> e;
    e << state.T_camera_target.translation() - truth.translation(), turn.angle() * turn.axis();
    const auto limit = bound.at(truth, landmark.picture(truth, 0, 0), sigma_grey);
    goals.over_bound += e.cwiseAbs2().cwiseQuotient(limit.covariance.diagonal()) / poses;
    goals.misfit_grey.push_back(limit.misfit_grey);
    const auto& C = estimator.last_dense().covariance;
    goals.chi2_pose += e.dot(C.ldlt().solve(e));
    const Eigen::Matrix3d position = C.topLeftCorner<3, 3>();
    goals.chi2_position += e.head<3>().dot(position.ldlt().solve(e.head<3>()));
    x.push_back(e(0)), y.push_back(e(1)), z.push_back(e(2));
    bound_x.push_back(std::sqrt(limit.covariance(0, 0))), bound_z.push_back(std::sqrt(limit.covariance(2, 2)));
  }
  goals.poses = poses;
  goals.over_bound = goals.over_bound.cwiseSqrt();
  goals.x = servo::spread_of(x), goals.y = servo::spread_of(y), goals.z = servo::spread_of(z);
  goals.bound_x = servo::spread_of(bound_x), goals.bound_z = servo::spread_of(bound_z);
  return goals;
}

}  // namespace heartservo::test
