#include "tracking/frames/v4l2/formats.hpp"

#include <linux/videodev2.h>

#include <algorithm>

namespace heartservo::tracking::v4l2 {

const std::vector<std::string>& format_names() {
  static const std::vector<std::string> names{"YUYV", "UYVY", "NV12", "YU12", "GREY", "RGB3", "BGR3", "MJPG"};
  return names;
}

std::string fourcc_name(std::uint32_t fourcc) {
  std::string name;
  for (int shift = 0; shift < 32; shift += 8) {
    const char c = static_cast<char>((fourcc & 0x7fffffffu) >> shift & 0xff);
    name += c > ' ' && c < 127 ? c : ' ';
  }
  name.erase(name.find_last_not_of(' ') + 1);
  return name;
}

std::uint32_t fourcc_of(const std::string& name) {
  if (name.size() != 4) return 0;
  return v4l2_fourcc(static_cast<std::uint32_t>(name[0]), static_cast<std::uint32_t>(name[1]),
                     static_cast<std::uint32_t>(name[2]), static_cast<std::uint32_t>(name[3]));
}

bool can_decode(std::uint32_t fourcc) {
  if (fourcc == V4L2_PIX_FMT_JPEG) return true;
  return std::any_of(format_names().begin(), format_names().end(),
                     [=](const std::string& name) { return fourcc_of(name) == fourcc; });
}

std::size_t picture_bytes(std::uint32_t fourcc, std::uint32_t bytes_per_line, int height) {
  const std::size_t plane = std::size_t(bytes_per_line) * static_cast<std::size_t>(height);
  switch (fourcc) {
    case V4L2_PIX_FMT_NV12:
    case V4L2_PIX_FMT_YUV420:
      return plane + plane / 2;
    case V4L2_PIX_FMT_MJPEG:
    case V4L2_PIX_FMT_JPEG:
      return 0;
    default:
      return plane;
  }
}

}  // namespace heartservo::tracking::v4l2
