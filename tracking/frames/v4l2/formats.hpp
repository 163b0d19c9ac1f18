#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace heartservo::tracking::v4l2 {

/// Pixel formats that we decode ourselves, those first that are wanted first: little to convert, then colour.
const std::vector<std::string>& format_names();

/// "YUYV" of its number, and back (0 for no such name).
std::string fourcc_name(std::uint32_t fourcc);
std::uint32_t fourcc_of(const std::string& name);

/// True for a format of format_names(); MJPG stands for JPEG too.
bool can_decode(std::uint32_t fourcc);

/// Bytes of a picture; 0 for a compressed format. `bytes_per_line` is of the first plane.
std::size_t picture_bytes(std::uint32_t fourcc, std::uint32_t bytes_per_line, int height);

}  // namespace heartservo::tracking::v4l2
