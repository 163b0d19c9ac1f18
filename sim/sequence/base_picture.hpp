#pragma once
// The pictures that artificial sequences move.
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace heartservo::sim {

/// CV_32FC1, grey 0..255, finer than the frames made of it.
struct BasePicture {
  cv::Mat grey;
  double texels_per_px = 2;  ///< texels per pixel of the first frame
};

/// Names of the procedural pictures:
/// heart   the simulated heart's tissue (tissue_texture.hpp), as seen at 10.8 px per mm
/// retina  fine branching vessels on smooth tissue
/// detail  a detailed photograph: overlapping leaves of all sizes ("dead leaves", Lee, Mumford & Huang, IJCV 2001),
/// whose
///         statistics are those of photographs
const std::vector<std::string>& base_picture_names();

/// A procedural picture by name, or a picture file. Throws InputError (file).
BasePicture make_base_picture(const std::string& texture, std::uint64_t seed);

}  // namespace heartservo::sim
