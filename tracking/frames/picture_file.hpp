#pragma once
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace heartservo::tracking {

/// A picture from disk, or why there is none.
struct Picture {
  cv::Mat grey;         ///< CV_8UC1
  cv::Mat colour;       ///< CV_8UC3 BGR, empty for a grey file
  std::string problem;  ///< "" when the picture is whole; else one line naming the file
};

/// Reads png, jpg, bmp, tif, pgm, ppm, webp (8 bit; 16 bit is scaled). A picture that is cut off or damaged is a
/// problem, never half a picture. Throws nothing.
Picture read_picture(const std::string& file);

/// True for a name that ends like a picture's, upper or lower case.
bool has_picture_name(const std::string& file);

/// "png, jpg, ...", for messages.
std::string picture_names();

/// True when the file starts with text only. False for an empty file.
bool looks_like_text(const std::string& file);

/// "" when the encoded picture is all there, else what is wrong. OpenCV fills the rest of a truncated JPEG with grey
/// and says nothing, and libpng writes to stderr. Knows PNG (to the last checksum), JPEG, BMP, PGM/PPM and WebP by
/// their first bytes; others are left to their decoder.
std::string missing_part(const std::vector<std::uint8_t>& bytes);

}  // namespace heartservo::tracking
