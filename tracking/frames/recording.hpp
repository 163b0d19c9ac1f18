#pragma once
// What `heartservo capture` records: a folder with pictures and when they were taken.
//
//     frames.csv   a row a picture: time_s, frame/sequence, frame/status, capture/...
//     video.mkv    the pictures (FFV1: lossless), or
//     pictures/    000000.png, ...
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "tracking/frames/frame_source.hpp"

namespace heartservo::tracking {

struct Frame;

inline constexpr const char* RECORDED_ROWS = "frames.csv";
inline constexpr const char* RECORDED_VIDEO = "video.mkv";
inline constexpr const char* RECORDED_PICTURES = "pictures";

/// Header and row of frames.csv. A cell is empty where the frame has no capture stamp.
std::string recorded_header();
std::string recorded_row(const Frame& frame);

/// True for such a folder: frames.csv with capture columns, and pictures.
bool is_recording(const std::filesystem::path& folder);

/// Its frames with the time stamps, numbers and states that they were captured with. frame_rate_hz() is the median.
/// Rows without a picture (a recording that was killed) and pictures without a row end it. Throws InputError.
std::unique_ptr<FrameSource> open_recording(const std::filesystem::path& folder);

}  // namespace heartservo::tracking
