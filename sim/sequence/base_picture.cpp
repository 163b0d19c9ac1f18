#include "sim/sequence/base_picture.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <opencv2/imgproc.hpp>

#include "sim/endoscope/tissue_paint.hpp"
#include "tracking/frames/picture_file.hpp"
#include "tracking/settings/errors.hpp"
#include "tracking/settings/yaml_reader.hpp"

namespace heartservo::sim {

namespace {

constexpr int kSize = 1664;  // texels: a frame of 512 px with 160 px around it, two texels to a pixel
constexpr double kTexelsPerPx = 2;
constexpr double kTexelsPerMm = 10.8 * kTexelsPerPx;
constexpr double kBlur = 0.9;            // texels, standard deviation: about half a pixel, that of a good lens
constexpr double kPhotographBlur = 1.5;  // texels

cv::Mat heart(std::uint64_t seed) {
  TextureOptions options;
  options.size = kSize;
  options.extent_m = kSize / kTexelsPerMm * 1e-3;
  cv::Mat grey = paint_tissue(options, seed).grey;
  cv::GaussianBlur(grey, grey, {}, kBlur);
  return grey;
}

cv::Mat retina(std::uint64_t seed) {
  cv::RNG random(seed ^ 0x5e71ULL);
  const cv::Mat slow = smooth_noise(kSize, 500, random), middle = smooth_noise(kSize, 60, random),
                fine = smooth_noise(kSize, 7, random);
  cv::Mat vessels = paint_vessels(kSize, 1.3e3 * kTexelsPerMm, 2.6, random);
  cv::GaussianBlur(vessels, vessels, {}, 1.8);
  cv::Mat grey = 125 + 14 * slow + 3 * middle + 2.2 * fine;
  grey -= 36 * vessels;
  return cv::max(4, cv::min(250, grey));
}

// One leaf: a disc, an ellipse or a rectangle, turned anyhow.
void draw_leaf(cv::Mat& grey, double radius, cv::RNG& random) {
  constexpr int kShift = 4;
  const cv::Point2d at(random.uniform(-radius, kSize + radius), random.uniform(-radius, kSize + radius));
  const double tone = std::clamp(118 + random.gaussian(17), 24.0, 205.0);
  if (random.uniform(0, 2) == 0) {
    cv::ellipse(grey, {cvRound(at.x * 16), cvRound(at.y * 16)},
                {cvRound(radius * 16), cvRound(radius * random.uniform(6.0, 16.0))}, random.uniform(0.0, 180.0), 0, 360,
                tone, cv::FILLED, cv::LINE_AA, kShift);
    return;
  }
  const double angle = random.uniform(0.0, M_PI), flat = random.uniform(0.3, 1.0);
  const cv::Point2d along(radius * std::cos(angle), radius * std::sin(angle)), across(-flat * along.y, flat * along.x);
  std::vector<cv::Point> corners;
  for (const auto& corner : {at - along - across, at + along - across, at + along + across, at - along + across})
    corners.emplace_back(cvRound(corner.x * 16), cvRound(corner.y * 16));
  cv::fillConvexPoly(grey, corners, tone, cv::LINE_AA, kShift);
}

cv::Mat detail(std::uint64_t seed) {
  cv::RNG random(seed ^ 0xdeadULL);
  cv::Mat leaves(kSize, kSize, CV_8UC1, cv::Scalar(118)), grey;
  constexpr double kSmallest = 5, kLargest = 160;  // texels; radii with density 1 / r^3, every later leaf on top
  constexpr int kLeaves = 26000;
  for (int i = 0; i < kLeaves; ++i) {
    const double p = random.uniform(0.0, 1.0), a = 1 / (kSmallest * kSmallest), b = 1 / (kLargest * kLargest);
    draw_leaf(leaves, 1 / std::sqrt(a - p * (a - b)), random);
  }
  leaves.convertTo(grey, CV_32FC1);
  grey += 4 * smooth_noise(kSize, 40, random) + 3 * smooth_noise(kSize, 9, random);
  cv::GaussianBlur(grey, grey, {}, kPhotographBlur);
  return grey;
}

// A picture file fills the frame; a finer one is brought down to two texels per pixel.
BasePicture from_file(const std::string& file) {
  constexpr int kFrame = 512;  // px
  tracking::Picture picture = tracking::read_picture(file);
  if (!picture.problem.empty()) throw InputError(picture.problem);
  if (std::min(picture.grey.cols, picture.grey.rows) < 64)
    throw InputError(fmt::format("{}: {} x {} px are too few for a sequence; 64 are needed", file, picture.grey.cols,
                                 picture.grey.rows));
  BasePicture base;
  const double density = static_cast<double>(std::min(picture.grey.cols, picture.grey.rows)) / kFrame;
  picture.grey.convertTo(base.grey, CV_32FC1);
  if (density > kTexelsPerPx)
    cv::resize(base.grey, base.grey, {}, kTexelsPerPx / density, kTexelsPerPx / density, cv::INTER_AREA);
  base.texels_per_px = std::clamp(density, 1.0, kTexelsPerPx);
  return base;
}

}  // namespace

const std::vector<std::string>& base_picture_names() {
  static const std::vector<std::string> names{"heart", "retina", "detail"};
  return names;
}

BasePicture make_base_picture(const std::string& texture, std::uint64_t seed) {
  if (texture == "heart") return {heart(seed), kTexelsPerPx};
  if (texture == "retina") return {retina(seed), kTexelsPerPx};
  if (texture == "detail") return {detail(seed), kTexelsPerPx};
  if (!std::filesystem::exists(texture))
    throw ConfigError(fmt::format("texture '{}' is neither a picture file nor known{}; choose one of {}", texture,
                                  did_you_mean(texture, base_picture_names()), fmt::join(base_picture_names(), ", ")));
  return from_file(texture);
}

}  // namespace heartservo::sim
