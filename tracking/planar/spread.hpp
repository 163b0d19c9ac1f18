#pragma once
#include <cstdint>
#include <vector>

namespace heartservo::tracking {

/// The greatest of the (2 reach + 1)² pixels around each, those outside the picture left out: what cv::dilate does to a
/// mask, with the memory that it is given. Row by row, no gaps; `to` may be `from`.
void spread(const std::uint8_t* from, int cols, int rows, int reach, std::uint8_t* to,
            std::vector<std::uint8_t>& scratch);

}  // namespace heartservo::tracking
