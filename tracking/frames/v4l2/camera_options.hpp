#pragma once
// How a camera is to be set up: "v4l2:/dev/video0,format=MJPG,size=1280x720,rate=60,input=HDMI,crop=round,gain=10".
#include <opencv2/core/types.hpp>
#include <string>
#include <utility>
#include <vector>

namespace heartservo::tracking::v4l2 {

struct CameraOptions {
  std::string device;  ///< /dev/video0
  std::string format;  ///< GREY, YUYV, UYVY, NV12, YU12, RGB3, BGR3 or MJPG; "": the first of these that it has
  cv::Size size;       ///< px; empty: the device's own (HDMI: that of the signal)
  double rate_hz = 0;  ///< 0: the device's own
  std::string input;   ///< number or part of its name; "": the one that is chosen
  std::string fields = "double";  ///< interlaced: `double` the lines of a field, or `refuse`
  std::string crop;               ///< "", "round" (the endoscope's picture is found in the first one) or x:y:w:h in px
  std::vector<std::pair<std::string, std::string>> controls;  ///< name and value, set in this order
  bool every_frame = false;  ///< false: always the newest; true: all in order, as long as the queue (2 s) holds
  int buffers = 6;           ///< asked of the driver
  double no_frame_s = 0.5;   ///< without a good frame for so long, or for 5 periods, the stream counts as starved
  double frozen_s = 1;       ///< identical pictures for so long are frozen; 0: never
  double give_up_s = 30;     ///< a device that is away longer ends the frames
  double signal_check_s = 0.25;
};

/// True for a source that begins with "v4l2:".
bool is_camera(const std::string& source);

/// Reads the form above; also "/dev/video0,..." without "v4l2:". A key that is no option is a control, which only the
/// device can refuse. Throws ConfigError.
CameraOptions parse_camera(const std::string& source);

/// "key=..." with what it means, a line each, for --help.
std::string camera_option_help();

}  // namespace heartservo::tracking::v4l2
