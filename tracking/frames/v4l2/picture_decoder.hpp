#pragma once
// Bytes of a driver's buffer to a grey picture for tracking and a colour one for people.
#include <opencv2/core/mat.hpp>
#include <span>
#include <string>

#include "tracking/frames/v4l2/set_up.hpp"

namespace heartservo::tracking::v4l2 {

class PictureDecoder {
 public:
  /// `crop`: empty for the whole picture.
  PictureDecoder(const Granted& granted, cv::Rect crop);
  ~PictureDecoder();
  PictureDecoder(const PictureDecoder&) = delete;
  PictureDecoder& operator=(const PictureDecoder&) = delete;

  void crop_to(const cv::Rect& crop) { crop_ = crop; }
  /// Of what decode() makes.
  cv::Size size() const { return crop_.area() > 0 ? crop_.size() : granted_.size; }

  /// `field` is the buffer's (of alternating ones, which of both it is). Grey is the luma, except from RGB; colour is
  /// empty for a grey format, or where it is not wanted. "" or what is wrong with the bytes.
  std::string decode(std::span<const std::uint8_t> bytes, std::uint32_t field, bool with_colour, cv::Mat& grey,
                     cv::Mat& colour);

 private:
  std::string decode_jpeg(std::span<const std::uint8_t> bytes, bool with_colour, cv::Mat& grey, cv::Mat& colour);
  std::string decode_raw(std::span<const std::uint8_t> bytes, int height, bool with_colour, cv::Mat& grey,
                         cv::Mat& colour);

  Granted granted_;
  cv::Rect crop_;
  void* jpeg_ = nullptr;  // tjhandle
};

/// Shows one field in all lines of a picture: those that the field lacks are means of their neighbours.
/// `woven`: the picture holds both fields; else it is one field, half as high. `bottom`: the field whose lines are the
/// second, fourth, ... of the whole picture.
cv::Mat double_lines(const cv::Mat& picture, bool woven, bool bottom);

}  // namespace heartservo::tracking::v4l2
