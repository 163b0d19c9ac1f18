#pragma once
// How much a region of a picture moves over a run, by dense optical flow that knows nothing of the tracker (DIS, Kroeger
// et al., ECCV 2016, as in OpenCV): the flow from the first picture to every other, started from the one before.
#include <Eigen/Core>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "tracking/planar/quad.hpp"

namespace cv {
class DISOpticalFlow;
}

namespace heartservo::tools {

class ImageMotion {
 public:
  explicit ImageMotion(const tracking::Quad& region);
  ~ImageMotion();

  /// The next picture (CV_8UC1). Returns the region's mean displacement since the first, px.
  Eigen::Vector2d add(const cv::Mat& grey);

  /// Root mean square, over time and the region's pixels, of the displacement around each pixel's mean place, px.
  double rms_px() const;

 private:
  cv::Rect region_, around_;
  cv::Ptr<cv::DISOpticalFlow> flow_;
  cv::Mat first_, now_, displacement_;
  std::vector<Eigen::Vector2d> sums_;
  std::vector<double> squares_;
  std::size_t count_ = 0;
};

}  // namespace heartservo::tools
