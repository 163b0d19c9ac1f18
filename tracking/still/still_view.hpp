#pragma once
// A picture in which the followed region stands still (the paper's key issue 3, visual stabilisation): every pixel is
// taken from where the tracker says that its piece of tissue lies now. Inside the region that is the tracker's own
// model, homography or bend (TargetTracker::carry); away from it the model would be extrapolated, so it fades into the
// similarity nearest to the region's corners. What lies outside the present picture is filled from the recent past.
#include <opencv2/core.hpp>

#include "tracking/planar/target_tracker.hpp"

namespace heartservo::tracking {

class StillView {
 public:
  /// `region`: the quad the tracker was started with, px; `size`: of the pictures.
  StillView(const Quad& region, cv::Size size);

  /// The still picture of `picture` (CV_8UC1 or CV_8UC3), in which `tracker` has just given `track`. While the region
  /// is LOST the last still picture stays. Valid until the next call; nothing is allocated after the first.
  const cv::Mat& update(const cv::Mat& picture, const TargetTracker& tracker, const Track& track);

 private:
  void find_sources(const TargetTracker& tracker, const Track& track);

  Quad region_;
  cv::Size size_;
  cv::Mat coarse_, fine_, warped_, inside_, ones_, still_;
};

/// The similarity (2 x 3: scale, rotation, shift) that takes `from` nearest to `to`, least squares over the corners.
Eigen::Matrix<double, 2, 3> similarity_between(const Quad& from, const Quad& to);

}  // namespace heartservo::tracking
