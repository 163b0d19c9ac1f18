#pragma once
#include <memory>
#include <string>

#include "tracking/frames/frame_source.hpp"

namespace heartservo::tracking {

/// A video file, through FFmpeg. time_s = sequence / rate; the rate is `frame_rate_hz`, or the file's own when that is
/// <= 0, or 25 Hz when the file has none. frame_count() is what the file's header claims, nothing where it claims
/// nothing. Throws InputError for a file that is missing, no video, or without a frame that can be decoded.
std::unique_ptr<FrameSource> open_video_file(const std::string& file, double frame_rate_hz);

}  // namespace heartservo::tracking
