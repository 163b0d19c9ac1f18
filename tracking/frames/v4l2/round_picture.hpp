#pragma once
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>

namespace heartservo::tracking::v4l2 {

/// An endoscope's picture is a bright disc on black, whole or cut by the border. Its bounding square, inside the
/// picture, with even place and size; nothing where there is no such disc (a full picture, or a dark one).
std::optional<cv::Rect> round_picture(const cv::Mat& grey);

/// What crop=... stands for in a picture: empty for "". Throws DeviceError: nothing round there, or outside.
cv::Rect crop_of(const std::string& crop, const cv::Mat& grey, const std::string& device);

}  // namespace heartservo::tracking::v4l2
