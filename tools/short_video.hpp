#pragma once
// A few seconds of a run as people want to see them, for the page: the endoscope's picture with what was found in it,
// beside the picture in which the region stands still; and how still that is.
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "tracking/planar/target_tracker.hpp"

namespace heartservo::tracking {
struct Frame;
}

namespace heartservo::tools {

class ShortVideo {
 public:
  /// Written to `file` (WebM, VP8: every browser plays it) from the first frame at or after `from_s` on in which
  /// the region is seen, at most 25 pictures a second for 4 s. `region`: that of the tracker; `size`: of the pictures; px.
  ShortVideo(const std::filesystem::path& file, double from_s, double frame_rate_hz, const tracking::Quad& region,
             cv::Size size);
  ~ShortVideo();

  /// Whether this frame is to be given to add().
  bool wants(const tracking::Frame& frame) const;
  /// `drawn`: the frame with its overlay, CV_8UC3.
  void add(const tracking::Frame& frame, const cv::Mat& drawn, const tracking::TargetTracker& tracker,
           const tracking::Track& track);

  /// Ends the file. Null when fewer than two frames came, and then there is no file; else raw_px and still_px, RMS motion
  /// of the region in the two pictures by optical flow, reduction_percent, from_s, to_s, frames.
  nlohmann::json finish();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace heartservo::tools
