#include <gtest/gtest.h>
#include <turbojpeg.h>

#include <opencv2/imgproc.hpp>

#include "tests/support/message.hpp"
#include "tracking/frames/v4l2/formats.hpp"
#include "tracking/frames/v4l2/picture_decoder.hpp"
#include "tracking/frames/v4l2/round_picture.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::test {
namespace {

using namespace tracking::v4l2;

constexpr int W = 64, H = 48;

cv::Mat luma() {
  cv::Mat picture(H, W, CV_8UC1);
  for (int v = 0; v < H; ++v)
    for (int u = 0; u < W; ++u) picture.at<std::uint8_t>(v, u) = static_cast<std::uint8_t>(30 + 2 * u + 2 * v);
  return picture;
}

Granted granted(const std::string& format, std::uint32_t bytes_per_line, std::uint32_t field = V4L2_FIELD_NONE) {
  Granted g;
  g.fourcc = fourcc_of(format);
  g.size = {W, H};
  g.bytes_per_line = bytes_per_line;
  g.field = field;
  return g;
}

struct Decoded {
  std::string problem;
  cv::Mat grey, colour;
};
Decoded decode(const Granted& g, const std::vector<std::uint8_t>& bytes, std::uint32_t field = V4L2_FIELD_NONE,
               cv::Rect crop = {}) {
  Decoded d;
  PictureDecoder decoder(g, crop);
  d.problem = decoder.decode(bytes, field, true, d.grey, d.colour);
  return d;
}

// A buffer of `format` whose luma is luma() and whose colour is `cb`, `cr`; lines with `padding` bytes after them.
std::vector<std::uint8_t> buffer_of(const std::string& format, std::size_t padding, std::uint8_t cb, std::uint8_t cr) {
  const cv::Mat y = luma();
  std::vector<std::uint8_t> bytes;
  const auto pad = [&](std::size_t count) { bytes.insert(bytes.end(), count, 0xee); };
  for (int v = 0; v < H; ++v) {
    for (int u = 0; u < W; ++u) {
      const std::uint8_t luminance = y.at<std::uint8_t>(v, u), chroma = u % 2 ? cr : cb;
      if (format == "YUYV")
        bytes.insert(bytes.end(), {luminance, chroma});
      else if (format == "UYVY")
        bytes.insert(bytes.end(), {chroma, luminance});
      else if (format == "RGB3" || format == "BGR3")
        bytes.insert(bytes.end(), 3, luminance);
      else
        bytes.push_back(luminance);
    }
    pad(padding);
  }
  if (format == "NV12")
    for (int v = 0; v < H / 2; ++v, pad(padding))
      for (int u = 0; u < W / 2; ++u) bytes.insert(bytes.end(), {cb, cr});
  if (format == "YU12")
    for (const std::uint8_t c : {cb, cr})
      for (int v = 0; v < H / 2; ++v, pad(padding / 2)) bytes.insert(bytes.end(), W / 2, c);
  return bytes;
}

class RawFormat : public testing::TestWithParam<std::string> {};

TEST_P(RawFormat, GreyIsTheLumaExactlyAndColourIsRight) {
  const std::string format = GetParam();
  const std::uint32_t bytes_a_pixel = format == "YUYV" || format == "UYVY"   ? 2
                                      : format == "RGB3" || format == "BGR3" ? 3
                                                                             : 1;
  for (const std::uint32_t padding : {0u, 32u}) {
    const auto bytes = buffer_of(format, padding, 90, 170);
    const auto d = decode(granted(format, W * bytes_a_pixel + padding), bytes);
    ASSERT_EQ(d.problem, "");
    EXPECT_EQ(cv::norm(d.grey, luma(), cv::NORM_INF), 0) << padding;
    if (format == "GREY") {
      EXPECT_TRUE(d.colour.empty());
      continue;
    }
    const int v = 10, u = 20, y = luma().at<std::uint8_t>(v, u);
    const auto bgr = d.colour.at<cv::Vec3b>(v, u);
    const bool rgb = bytes_a_pixel == 3;
    // BT.601, limited range
    const double scaled = 1.164 * (y - 16);
    EXPECT_NEAR(bgr[0], rgb ? y : scaled + 2.018 * (90 - 128), 2);
    EXPECT_NEAR(bgr[1], rgb ? y : scaled - 0.391 * (90 - 128) - 0.813 * (170 - 128), 2);
    EXPECT_NEAR(bgr[2], rgb ? y : scaled + 1.596 * (170 - 128), 2);
    auto cut = bytes;
    cut.resize(bytes.size() / 2);
    EXPECT_NE(decode(granted(format, W * bytes_a_pixel + padding), cut).problem.find("bytes"), std::string::npos);
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, RawFormat, testing::Values("GREY", "YUYV", "UYVY", "NV12", "YU12", "RGB3", "BGR3"),
                         [](const auto& format) { return format.param; });

std::vector<std::uint8_t> jpeg(cv::Size size, int sampling) {
  cv::Mat bgr(size, CV_8UC3);
  for (int v = 0; v < size.height; ++v)
    for (int u = 0; u < size.width; ++u)
      bgr.at<cv::Vec3b>(v, u) = cv::Vec3b(static_cast<std::uint8_t>(u * 3), static_cast<std::uint8_t>(60 + v), 128);
  tjhandle handle = tjInitCompress();
  unsigned char* out = nullptr;
  unsigned long length = 0;
  tjCompress2(handle, bgr.data, size.width, static_cast<int>(bgr.step), size.height, TJPF_BGR, &out, &length, sampling,
              95, 0);
  std::vector<std::uint8_t> bytes(out, out + length);
  tjFree(out);
  tjDestroy(handle);
  return bytes;
}

// A webcam's JPEG has no Huffman tables: it means the standard's.
std::vector<std::uint8_t> without_huffman_tables(const std::vector<std::uint8_t>& bytes) {
  std::vector<std::uint8_t> result(bytes.begin(), bytes.begin() + 2);
  std::size_t i = 2;
  while (bytes[i + 1] != 0xda) {
    const std::size_t next = i + 2 + (std::size_t(bytes[i + 2]) << 8 | bytes[i + 3]);
    if (bytes[i + 1] != 0xc4)
      result.insert(result.end(), bytes.begin() + static_cast<std::ptrdiff_t>(i),
                    bytes.begin() + static_cast<std::ptrdiff_t>(next));
    i = next;
  }
  result.insert(result.end(), bytes.begin() + static_cast<std::ptrdiff_t>(i), bytes.end());
  return result;
}

TEST(Jpeg, EverySamplingWithAndWithoutHuffmanTables) {
  for (const int sampling : {TJSAMP_444, TJSAMP_422, TJSAMP_420, TJSAMP_GRAY}) {
    const auto bytes = jpeg({W, H}, sampling);
    const auto d = decode(granted("MJPG", 0), bytes);
    ASSERT_EQ(d.problem, "") << sampling;
    EXPECT_EQ(d.colour.empty(), sampling == TJSAMP_GRAY);
    cv::Mat from_colour;
    if (!d.colour.empty()) {
      cv::cvtColor(d.colour, from_colour, cv::COLOR_BGR2GRAY);
      EXPECT_LE(cv::norm(d.grey, from_colour, cv::NORM_INF), 3);
    }
    EXPECT_NEAR(d.grey.at<std::uint8_t>(20, 30), 0.114 * 90 + 0.587 * 80 + 0.299 * 128, 4);
    const auto bare = without_huffman_tables(bytes);
    ASSERT_LT(bare.size(), bytes.size());
    const auto same = decode(granted("MJPG", 0), bare);
    ASSERT_EQ(same.problem, "");
    EXPECT_EQ(cv::norm(d.grey, same.grey, cv::NORM_INF), 0);
  }
}

TEST(Jpeg, DamagedOnesAreRefused) {
  auto bytes = jpeg({W, H}, TJSAMP_420);
  EXPECT_NE(decode(granted("MJPG", 0), {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(bytes.size() / 2)})
                .problem,
            "");
  EXPECT_NE(decode(granted("MJPG", 0), {0, 1, 2, 3}).problem.find("is no JPEG"), std::string::npos);
  EXPECT_NE(decode(granted("MJPG", 0), jpeg({32, 32}, TJSAMP_420)).problem.find("32 x 32 px instead of 64 x 48"),
            std::string::npos);
}

TEST(Fields, OneFieldIsShownInAllLines) {
  cv::Mat woven(8, 4, CV_8UC1);
  for (int row = 0; row < 8; ++row) woven.row(row).setTo(row % 2 ? 200 : 10 * row);
  const cv::Mat top = double_lines(woven, true, false);
  EXPECT_EQ(top.size(), woven.size());
  EXPECT_EQ(top.at<std::uint8_t>(4, 1), 40);
  EXPECT_EQ(top.at<std::uint8_t>(3, 1), 30) << "between lines 2 and 4, not the other field's 200";
  EXPECT_EQ(top.at<std::uint8_t>(7, 1), 60) << "the last line has nothing below";
  cv::Mat half(4, 4, CV_8UC1);
  for (int row = 0; row < 4; ++row) half.row(row).setTo(10 + 20 * row);
  const cv::Mat bottom = double_lines(half, false, true);
  EXPECT_EQ(bottom.rows, 8);
  EXPECT_EQ(bottom.at<std::uint8_t>(0, 0), 10);
  EXPECT_EQ(bottom.at<std::uint8_t>(1, 0), 10);
  EXPECT_EQ(bottom.at<std::uint8_t>(2, 0), 20);
  EXPECT_EQ(bottom.at<std::uint8_t>(7, 0), 70);
}

// A vertical ramp sampled as two fields: both are shown where the ramp is, not a line apart.
TEST(Fields, BothFieldsLieOnTheSamePicture) {
  cv::Mat ramp(H, W, CV_8UC1), field(H / 2, W, CV_8UC1);
  for (int row = 0; row < H; ++row) ramp.row(row).setTo(4 * row);
  for (const bool bottom : {false, true}) {
    for (int row = 0; row < H / 2; ++row) ramp.row(2 * row + bottom).copyTo(field.row(row));
    std::vector<std::uint8_t> bytes(field.data, field.data + field.total());
    const auto d = decode(granted("GREY", W, V4L2_FIELD_ALTERNATE), bytes, bottom ? V4L2_FIELD_BOTTOM : V4L2_FIELD_TOP);
    ASSERT_EQ(d.problem, "");
    const cv::Rect inside(0, 1, W, H - 2);
    EXPECT_LE(cv::norm(d.grey(inside), ramp(inside), cv::NORM_INF), 0) << bottom;
  }
}

TEST(RoundPicture, IsFoundWholeAndCutByTheBorder) {
  for (const double cx : {320.0, 300.0}) {
    for (const double radius : {180.0, 250.0}) {
      cv::Mat grey(480, 640, CV_8UC1, cv::Scalar(8));
      cv::circle(grey, cv::Point(static_cast<int>(cx), 240), static_cast<int>(radius), 120, cv::FILLED);
      cv::circle(grey, cv::Point(static_cast<int>(cx) + 40, 250), 60, 5, cv::FILLED);  // something dark inside
      const auto found = round_picture(grey);
      ASSERT_TRUE(found) << cx << " " << radius;
      EXPECT_NEAR(found->x, cx - radius, 3);
      EXPECT_NEAR(found->x + found->width, cx + radius, 3);
      EXPECT_NEAR(found->y, std::max(0.0, 240 - radius), 3);
    }
  }
}

TEST(RoundPicture, IsNotSeenWhereThereIsNone) {
  EXPECT_FALSE(round_picture(cv::Mat(480, 640, CV_8UC1, cv::Scalar(120)))) << "a full picture";
  EXPECT_FALSE(round_picture(cv::Mat(480, 640, CV_8UC1, cv::Scalar(5)))) << "a dark one";
  cv::Mat square(480, 640, CV_8UC1, cv::Scalar(5));
  square(cv::Rect(160, 80, 320, 320)).setTo(140);
  EXPECT_FALSE(round_picture(square));
  EXPECT_NE(message_of<DeviceError>([&] { crop_of("round", square, "/dev/video0"); }).find("no bright disc"),
            std::string::npos);
  EXPECT_NE(message_of<DeviceError>([&] { crop_of("600:0:100:100", square, "x"); }).find("not inside"),
            std::string::npos);
  EXPECT_EQ(crop_of("16:8:100:90", square, "x"), cv::Rect(16, 8, 100, 90));
}

}  // namespace
}  // namespace heartservo::test
