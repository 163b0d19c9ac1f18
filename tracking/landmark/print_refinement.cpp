#include "tracking/landmark/print_refinement.hpp"

#include "tracking/frames/frame.hpp"
#include "tracking/landmark/dense_estimator.hpp"
#include "tracking/landmark/reprojection.hpp"

namespace heartservo::tracking {

namespace {

constexpr double kCornerSigma_px = 0.1;  // of corners on edges: weighs only which side of the plate is believed
constexpr double kFurthest_px = 1.5;     // a pose further from the corners than this has found something else

}  // namespace

Quad refine_by_print(const cv::Mat& grey, const Camera& camera, const Quad& corners, const cv::Mat& plate,
                     double side_m) {
  if (plate.empty() || !(side_m > 0)) return corners;
  DenseEstimator estimator(camera, side_m, plate, kCornerSigma_px);
  Frame frame;
  frame.grey = grey;
  Track track;
  track.sequence = frame.sequence;
  track.state = TrackState::OK;
  track.corners = corners;
  estimator.look_at(frame);
  const TargetState state = estimator.estimate(track);
  if (!estimator.last_dense().valid) return corners;
  const Quad found = project_square(camera, state.T_camera_target, side_m);
  for (int i = 0; i < 4; ++i)
    if (!((found[i] - corners[i]).norm() < kFurthest_px)) return corners;
  return found;
}

}  // namespace heartservo::tracking
