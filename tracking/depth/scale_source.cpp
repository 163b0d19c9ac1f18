#include "tracking/depth/scale_source.hpp"

#include "tracking/depth/stereo_depth_estimator.hpp"
#include "tracking/frames/frame.hpp"
#include "tracking/landmark/landmark_estimator.hpp"
#include "tracking/landmark/square_refinement.hpp"

namespace heartservo::tracking {

ScaleSource known_scale(const ScaleReference& scale) {
  return [scale](const Frame&, const Track&) { return scale; };
}

ScaleSource landmark_scale(const Camera& camera, const Quad& picked, double side_m, double edge_ratio,
                           double corner_sigma_px) {
  return [=](const Frame& frame, const Track& region) {
    Track landmark;
    landmark.state = TrackState::OK;
    landmark.corners = picked;
    if (edge_ratio > 0 && frame.status == FrameStatus::OK)
      landmark.corners = refine_square(frame.grey, camera, picked, edge_ratio).corners;
    LandmarkEstimator estimator(camera, side_m, "refined", corner_sigma_px);
    const TargetState pose = estimator.estimate(landmark);
    if (pose.state == TrackState::LOST) return ScaleReference{};
    return scale_from_landmark(camera, pose,
                               pose_covariance(camera, pose.T_camera_target, side_m, corner_sigma_px), region.target);
  };
}

ScaleSource stereo_scale(const StereoCamera& camera, const StereoOptions& options) {
  const auto estimator = std::make_shared<StereoDepthEstimator>(camera, options, 0.1);
  return [estimator](const Frame& frame, const Track& region) {
    ScaleReference scale;
    estimator->look_at(frame);
    const TargetState pose = estimator->estimate(region);
    if (pose.state != TrackState::OK) return scale;
    const Eigen::Vector3d normal = pose.T_camera_target.linear().col(2);
    scale.depth_m = pose.T_camera_target.translation().z();
    scale.sigma_m = estimator->last_match().sigma_m;
    scale.slope = -normal.head<2>() / normal.z();
    scale.slope_sigma = 0.1;  // the region is matched by a plane at its centre; it bends
    return scale;
  };
}

}  // namespace heartservo::tracking
