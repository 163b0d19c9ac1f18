#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "sim/endoscope/painted_pattern.hpp"
#include "sim/endoscope/tissue_paint.hpp"
#include "tools/texture/labelled_regions.hpp"

namespace heartservo::tools {

namespace {

constexpr int kSide = 40;
constexpr double kPxPerMm = 10.8;  // of the paper's endoscope at its working distance
constexpr double kLandmarkSide_mm = 5;
constexpr int kHearts = 4;  // textures that the regions are spread over

// Tissue as large on the picture as the endoscope shows it.
struct Heart {
  cv::Mat grey, fat, vessel;
};

Heart paint_heart(std::uint64_t seed, double fibre_angle_rad) {
  sim::TextureOptions options;
  options.size = 1024;
  options.extent_m = 0.04;  // as many texels per mm as the scenes have
  options.fibre_angle_rad = fibre_angle_rad;
  options.vessels = 2;
  const sim::TissueLayers layers = sim::paint_tissue(options, seed);
  const int size = static_cast<int>(1e3 * options.extent_m * kPxPerMm);
  Heart heart;
  cv::resize(layers.grey, heart.grey, {size, size}, 0, 0, cv::INTER_AREA);
  cv::resize(layers.fat, heart.fat, {size, size}, 0, 0, cv::INTER_AREA);
  cv::resize(layers.vessel, heart.vessel, {size, size}, 0, 0, cv::INTER_AREA);
  return heart;
}

// "" where several materials meet.
std::string material_at(const Heart& heart, const cv::Rect& where) {
  const double fat = cv::mean(heart.fat(where))[0], vessel = cv::mean(heart.vessel(where))[0];
  if (vessel > 0.15) return "vessel";
  if (vessel > 0.01) return "";
  return fat > 0.75 ? "fat" : fat < 0.1 ? "muscle" : "";
}

cv::Mat landmark(cv::RNG& random) {
  cv::Mat grey(kSide, kSide, CV_32FC1);
  const double half = 0.5 * kLandmarkSide_mm * kPxPerMm, angle = random.uniform(0.0, 2 * CV_PI);
  const double c = std::cos(angle), s = std::sin(angle), x0 = random.uniform(-0.2, 0.2), y0 = random.uniform(-0.2, 0.2);
  const auto id = static_cast<std::uint32_t>(random.uniform(0, 1000));
  for (int v = 0; v < kSide; ++v)
    for (int u = 0; u < kSide; ++u) {
      const double a = (u - 0.5 * (kSide - 1)) / half, b = (v - 0.5 * (kSide - 1)) / half;
      const double x = c * a + s * b + x0, y = c * b - s * a + y0;
      grey.at<float>(v, u) =
          static_cast<float>(sim::painted_pattern(id, std::clamp(x, -1.0, 1.0), std::clamp(y, -1.0, 1.0)));
    }
  return grey;
}

// Light that falls off over the region, the lens, and the sensor's noise.
cv::Mat seen(const cv::Mat& surface, cv::RNG& random) {
  cv::Mat grey, picture(surface.size(), CV_8UC1);
  cv::GaussianBlur(surface, grey, {}, random.uniform(0.5, 0.9), 0, cv::BORDER_REFLECT);
  const double gain = random.uniform(0.75, 1.2), slope_u = random.uniform(-0.003, 0.003),
               slope_v = random.uniform(-0.003, 0.003);
  for (int v = 0; v < grey.rows; ++v)
    for (int u = 0; u < grey.cols; ++u) {
      const double light = gain * (1 + slope_u * (u - 0.5 * kSide) + slope_v * (v - 0.5 * kSide));
      picture.at<std::uint8_t>(v, u) =
          cv::saturate_cast<std::uint8_t>(light * static_cast<double>(grey.at<float>(v, u)) + random.gaussian(2));
    }
  return picture;
}

}  // namespace

std::vector<LabelledRegion> simulated_regions(std::uint64_t seed, int per_class) {
  constexpr int kTries = 20000;  // per heart: where a material is rare, fewer regions
  cv::RNG random(seed * 0x9e3779b97f4a7c15u + 1);
  std::vector<LabelledRegion> regions;
  for (int h = 0; h < kHearts; ++h) {
    const int share = per_class * (h + 1) / kHearts - per_class * h / kHearts;
    const Heart heart = paint_heart(seed * kHearts + static_cast<std::uint64_t>(h), random.uniform(-1.5, 1.5));
    for (int i = 0; i < share; ++i) regions.push_back({seen(landmark(random), random), "landmark"});
    std::vector<std::pair<std::string, int>> wanted{{"muscle", share}, {"fat", share}, {"vessel", share}};
    for (int i = 0; i < kTries; ++i) {
      const cv::Rect where(random.uniform(0, heart.grey.cols - kSide), random.uniform(0, heart.grey.rows - kSide),
                           kSide, kSide);
      const std::string material = material_at(heart, where);
      for (auto& [name, left] : wanted)
        if (name == material && left > 0) {
          regions.push_back({seen(heart.grey(where), random), name});
          --left;
        }
      if (std::all_of(wanted.begin(), wanted.end(), [](const auto& w) { return w.second == 0; })) break;
    }
  }
  return regions;
}

}  // namespace heartservo::tools
