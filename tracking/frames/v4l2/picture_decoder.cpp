#include "tracking/frames/v4l2/picture_decoder.hpp"

#include <fmt/format.h>
#include <turbojpeg.h>

#include <opencv2/imgproc.hpp>

#include "tracking/frames/v4l2/formats.hpp"

namespace heartservo::tracking::v4l2 {

namespace {

bool is_jpeg(std::uint32_t fourcc) { return fourcc == V4L2_PIX_FMT_MJPEG || fourcc == V4L2_PIX_FMT_JPEG; }

cv::Mat view(const std::uint8_t* start, int rows, int cols, int type, std::size_t step) {
  return {rows, cols, type, const_cast<std::uint8_t*>(start), step};
}

// NV12 and YU12 whose chroma lines are as long as `step` says; OpenCV wants them without gaps.
cv::Mat packed_420(const std::uint8_t* start, cv::Size size, std::size_t step, bool planar) {
  const int w = size.width, h = size.height;
  cv::Mat packed(h * 3 / 2, w, CV_8UC1);
  view(start, h, w, CV_8UC1, step).copyTo(packed.rowRange(0, h));
  const std::uint8_t* chroma = start + step * static_cast<std::size_t>(h);
  if (!planar) {
    view(chroma, h / 2, w, CV_8UC1, step).copyTo(packed.rowRange(h, h * 3 / 2));
    return packed;
  }
  std::uint8_t* to = packed.ptr(h);
  for (int plane = 0; plane < 2; ++plane, chroma += step / 2 * static_cast<std::size_t>(h / 2))
    for (int row = 0; row < h / 2; ++row, to += w / 2)
      std::copy_n(chroma + step / 2 * static_cast<std::size_t>(row), w / 2, to);
  return packed;
}

}  // namespace

PictureDecoder::PictureDecoder(const Granted& granted, cv::Rect crop) : granted_(granted), crop_(crop) {
  if (is_jpeg(granted.fourcc)) jpeg_ = tjInitDecompress();
}

PictureDecoder::~PictureDecoder() {
  if (jpeg_) tjDestroy(jpeg_);
}

std::string PictureDecoder::decode_jpeg(std::span<const std::uint8_t> bytes, bool with_colour, cv::Mat& grey,
                                        cv::Mat& colour) {
  int width = 0, height = 0, sampling = 0, space = 0;
  const auto length = static_cast<unsigned long>(bytes.size());
  if (tjDecompressHeader3(jpeg_, bytes.data(), length, &width, &height, &sampling, &space) != 0)
    return fmt::format("is no JPEG: {}", tjGetErrorStr2(jpeg_));
  const cv::Size size(granted_.size.width, granted_.size.height / (is_single_field(granted_.field) ? 2 : 1));
  if (cv::Size(width, height) != size)
    return fmt::format("is a JPEG of {} x {} px instead of {} x {}", width, height, size.width, size.height);
  const auto decode = [&](int type, TJPF format, cv::Mat& to) {
    to.create(size, type);
    // a picture with a warning is damaged: the decoder filled the rest with grey
    return tjDecompress2(jpeg_, bytes.data(), length, to.data, width, static_cast<int>(to.step), height, format, 0) ==
           0;
  };
  if (!decode(CV_8UC1, TJPF_GRAY, grey) ||
      (with_colour && sampling != TJSAMP_GRAY && !decode(CV_8UC3, TJPF_BGR, colour)))
    return fmt::format("is a damaged JPEG: {}", tjGetErrorStr2(jpeg_));
  return "";
}

std::string PictureDecoder::decode_raw(std::span<const std::uint8_t> bytes, int height, bool with_colour, cv::Mat& grey,
                                       cv::Mat& colour) {
  const std::size_t step = granted_.bytes_per_line,
                    needed = picture_bytes(granted_.fourcc, granted_.bytes_per_line, height);
  if (bytes.size() < needed) return fmt::format("has {} of {} bytes", bytes.size(), needed);
  const int width = granted_.size.width;
  const std::uint8_t* start = bytes.data();
  const auto packed_422 = [&](int luma, int code) {
    const cv::Mat both = view(start, height, width, CV_8UC2, step);
    cv::extractChannel(both, grey, luma);
    if (with_colour) cv::cvtColor(both, colour, code);
  };
  const auto rgb = [&](int to_grey, bool swap) {
    const cv::Mat given = view(start, height, width, CV_8UC3, step);
    cv::cvtColor(given, grey, to_grey);
    if (with_colour && swap) cv::cvtColor(given, colour, cv::COLOR_RGB2BGR);
    if (with_colour && !swap) given.copyTo(colour);
  };
  const auto planes_420 = [&](bool planar, int code) {
    view(start, height, width, CV_8UC1, step).copyTo(grey);
    if (with_colour) cv::cvtColor(packed_420(start, {width, height}, step, planar), colour, code);
  };
  switch (granted_.fourcc) {
    case V4L2_PIX_FMT_GREY:
      view(start, height, width, CV_8UC1, step).copyTo(grey);
      break;
    case V4L2_PIX_FMT_YUYV:
      packed_422(0, cv::COLOR_YUV2BGR_YUY2);
      break;
    case V4L2_PIX_FMT_UYVY:
      packed_422(1, cv::COLOR_YUV2BGR_UYVY);
      break;
    case V4L2_PIX_FMT_RGB24:
      rgb(cv::COLOR_RGB2GRAY, true);
      break;
    case V4L2_PIX_FMT_BGR24:
      rgb(cv::COLOR_BGR2GRAY, false);
      break;
    case V4L2_PIX_FMT_NV12:
      planes_420(false, cv::COLOR_YUV2BGR_NV12);
      break;
    case V4L2_PIX_FMT_YUV420:
      planes_420(true, cv::COLOR_YUV2BGR_I420);
      break;
    default:
      return fmt::format("is of the format {}, which is not known", fourcc_name(granted_.fourcc));
  }
  return "";
}

std::string PictureDecoder::decode(std::span<const std::uint8_t> bytes, std::uint32_t field, bool with_colour,
                                   cv::Mat& grey, cv::Mat& colour) {
  const bool single = is_single_field(granted_.field);
  grey.release();  // whoever holds the last one keeps it
  colour.release();
  const std::string problem =
      is_jpeg(granted_.fourcc)
          ? decode_jpeg(bytes, with_colour, grey, colour)
          : decode_raw(bytes, single ? granted_.size.height / 2 : granted_.size.height, with_colour, grey, colour);
  if (!problem.empty()) return problem;
  const bool sequential = granted_.field == V4L2_FIELD_SEQ_TB || granted_.field == V4L2_FIELD_SEQ_BT;
  for (cv::Mat* picture : {&grey, &colour}) {
    if (picture->empty()) continue;
    if (single)
      *picture = double_lines(*picture, false, field == V4L2_FIELD_BOTTOM);
    else if (sequential)  // the field that came first is the upper half
      *picture = double_lines(picture->rowRange(0, picture->rows / 2), false, granted_.field == V4L2_FIELD_SEQ_BT);
    else if (granted_.field == V4L2_FIELD_INTERLACED || granted_.field == V4L2_FIELD_INTERLACED_TB ||
             granted_.field == V4L2_FIELD_INTERLACED_BT)
      *picture = double_lines(*picture, true, granted_.field == V4L2_FIELD_INTERLACED_BT);
    if (crop_.area() > 0) *picture = (*picture)(crop_).clone();
  }
  return "";
}

}  // namespace heartservo::tracking::v4l2
