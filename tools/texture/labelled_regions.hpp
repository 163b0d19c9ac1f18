#pragma once
// Regions of pictures with class labels: what feature selection works on.
#include <cstdint>
#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "tracking/texture/levels.hpp"
#include "tracking/texture/selection.hpp"

namespace heartservo::tools {

/// Regions smaller than this on a side say too little about texture.
inline constexpr int kSmallestRegion_px = 12;

struct LabelledRegion {
  cv::Mat grey;  ///< CV_8UC1, the region alone
  std::string label;
};

/// The part `where` of the picture, named `name` in messages. Throws ConfigError: not inside, or smaller than 12 px.
cv::Mat region_of(const cv::Mat& grey, const cv::Rect& where, const std::string& name);

/// Reads a CSV with the header `file,x,y,width,height,class`; files relative to the CSV's folder, regions in px. Throws
/// InputError (file and line): unreadable, malformed, a picture that is missing or damaged, a region outside.
std::vector<LabelledRegion> read_labelled_regions(const std::filesystem::path& csv);

/// Regions of 40 x 40 px of the simulated heart as the endoscope sees it (10.8 px per mm), `per_class` of each class,
/// the material known from how it was painted: muscle, fat, vessel, landmark. Light, sharpness and noise vary from
/// region to region. The same seed gives the same regions.
std::vector<LabelledRegion> simulated_regions(std::uint64_t seed, int per_class);

/// The feature bank of each region. Classes in the order they appear.
tracking::FeatureTable feature_table(const std::vector<LabelledRegion>& regions,
                                     const tracking::TextureSettings& settings);

}  // namespace heartservo::tools
