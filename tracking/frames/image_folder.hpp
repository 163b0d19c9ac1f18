#pragma once
#include <memory>
#include <string>
#include <vector>

#include "tracking/frames/frame_source.hpp"

namespace heartservo::tracking {

/// Rate of pictures when none is given.
inline constexpr double PICTURE_RATE_HZ = 25;

/// The pictures of a folder in natural order (img2 before img10), or of a printf pattern like `dir/img%04d.png` from
/// the first number present in 0..10000 to the last one present. time_s = sequence / frame_rate_hz; a rate <= 0 means
/// 25 Hz. A picture that is missing inside a pattern, cut off, damaged or of another size than the first good one is an
/// UNREADABLE frame with a note. Throws InputError: no such path, no picture there, or none that can be read.
std::unique_ptr<FrameSource> open_image_folder(const std::string& path, double frame_rate_hz);

/// The same from a list of files in the order given; `description` names it in messages.
std::unique_ptr<FrameSource> open_image_files(std::vector<std::string> files, double frame_rate_hz,
                                              const std::string& description);

/// Natural order of names: runs of digits compare as numbers.
bool natural_less(const std::string& a, const std::string& b);

}  // namespace heartservo::tracking
