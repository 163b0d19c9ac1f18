#pragma once
// Where the camera's rays meet the heart's surface, and how the light falls there, at the nodes of a grid.
#include <vector>

#include "sim/endoscope/node_grid.hpp"
#include "sim/endoscope/picture_options.hpp"
#include "sim/heart/surface_state.hpp"

namespace heartservo::sim {

class SurfaceNodes {
 public:
  /// Planes of values at the nodes, in this order. Texture coordinates count from the texture's centre; the mirror
  /// slopes are those a wet bump needs to throw the light into the camera.
  enum Channel { kTexelX, kTexelY, kShade, kMirrorSlopeA, kMirrorSlopeB, kChannels };

  SurfaceNodes(const tracking::Camera& camera, const PictureOptions& options, double texels_per_m);

  /// Solves nodes [first, last) for the surface; nodes are independent of each other.
  void solve(const SurfaceState& state, int first, int last);

  /// m, in the frame of the camera that looks.
  void set_lamp(const Eigen::Vector3d& light_m) { light_m_ = light_m; }

  const NodeGrid& grid() const { return grid_; }
  const float* planes() const { return planes_.data(); }  ///< kChannels planes of grid().size()

 private:
  NodeGrid grid_;
  std::vector<double> rays_;
  std::vector<float> vignette_;
  std::vector<float> planes_;
  Eigen::Vector3d light_m_;
  double light_distance2_;
  double texels_per_m_;
  bool flat_;
};

}  // namespace heartservo::sim
