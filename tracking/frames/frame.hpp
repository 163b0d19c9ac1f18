#pragma once
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>

#include "tracking/frames/capture_stamp.hpp"

namespace heartservo::tracking {

enum class FrameStatus {
  OK,          ///< the picture is whole
  UNREADABLE,  ///< the frame exists but its picture is broken; `grey` is empty, `note` says why
  NOT_LIVE,    ///< a camera's picture of no living scene (frozen, or no signal): for the record, not to be tracked
};

/// One picture of the endoscope. The pixels are shared, not copied (cv::Mat).
struct Frame {
  cv::Mat grey;                ///< CV_8UC1, empty where it is UNREADABLE
  cv::Mat colour;              ///< CV_8UC3 BGR where the source has colour, else empty; only for people to look at
  cv::Mat right;               ///< CV_8UC1: the right view of a stereo endoscope at the same instant; empty for one view
  double time_s = 0;           ///< middle of the exposure
  std::uint64_t sequence = 0;  ///< counts every frame of the source, broken ones too
  FrameStatus status = FrameStatus::OK;
  std::string note;  ///< why a frame is not OK, naming the file or device
  std::optional<CaptureStamp> capture;  ///< of a live camera, or as a recording of one says
};

}  // namespace heartservo::tracking
