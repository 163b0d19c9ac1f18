#pragma once
// How far the run of each pixel goes, in eight directions: what makes the sliding run-length matrix exact and cheap.
#include <cstdint>
#include <vector>

#include "tracking/texture/levels.hpp"

namespace heartservo::tracking {

enum RunDirection { LEFT, RIGHT, UP, DOWN, UP_LEFT, UP_RIGHT, DOWN_LEFT, DOWN_RIGHT };

/// reach[direction]: pixels of the run from this pixel on, itself included, to the border of the picture.
struct alignas(16) RunReach {
  std::uint16_t reach[8];
};

class RunTable {
 public:
  /// For pictures of up to 65535 px a side. Allocates only for a larger picture than before.
  void build(const LevelRegion& picture);
  const RunReach* row(int y) const { return reach_.data() + static_cast<std::ptrdiff_t>(y) * width_; }

 private:
  int width_ = 0;
  std::vector<RunReach> reach_;
};

}  // namespace heartservo::tracking
