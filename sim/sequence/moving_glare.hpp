#pragma once
// Glare of wet tissue: saturated blobs that wander over the region and its surroundings.
#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace heartservo::sim {

/// Blobs of 3 to 8 px radius with an edge of one pixel. Each runs on an ellipse of its own around a point within 90 px
/// of the region's first centre (amplitudes 15 to 60 px, periods 40 to 120 frames); 16 of them cover about 4 % of a
/// region, 0 to 20 % in single frames.
class MovingGlare {
 public:
  MovingGlare(int blobs, const Eigen::Vector2d& centre_px, std::uint64_t seed);

  /// Lays the blobs of frame t over a row of `width` grey levels.
  void add_to_row(double t, int v, int width, float* grey) const;

 private:
  struct Blob {
    Eigen::Vector2d middle, amplitude;  // px
    double period, phase, radius;       // frames, rad, px
  };
  std::vector<Blob> blobs_;
};

}  // namespace heartservo::sim
