#pragma once
// Smooth functions of the pixel, known at coarse nodes and interpolated by cubic polynomials in between.
#include <Eigen/Core>
#include <functional>
#include <vector>

#include "tracking/camera/camera.hpp"

namespace heartservo::sim {

/// Nodes every `kNodeStep` px; node (row j, column i) lies at pixel ((i - 1) step, (j - 1) step), so that every pixel
/// of the picture has two nodes on each side.
class NodeGrid {
 public:
  static constexpr int kNodeStep = 4;

  NodeGrid() = default;
  NodeGrid(int width, int height);

  int width() const { return width_; }
  int height() const { return height_; }
  int columns() const { return columns_; }
  int rows() const { return rows_; }
  int size() const { return columns_ * rows_; }
  int padded_width() const { return (columns_ - 3) * kNodeStep; }  ///< px; a row buffer's size
  double u_px(int column) const { return (column - 1.0) * kNodeStep; }
  double v_px(int row) const { return (row - 1.0) * kNodeStep; }

  /// Row `v` (px) of `channels` planes of size() nodes each (one after the other) into as many rows of padded_width()
  /// values. `scratch` holds columns() values per channel.
  void interpolate_row(const float* nodes, int channels, int v, float* scratch, float* out) const;

 private:
  int width_ = 0, height_ = 0, columns_ = 0, rows_ = 0;
};

/// Undistorted normalised points (xn, yn) of the camera's rays through the nodes: two planes of grid.size() values.
/// Beyond the picture, where a camera may have no ray, the values continue those inside by cubic polynomials.
std::vector<double> node_rays(const tracking::Camera& camera, const NodeGrid& grid);

}  // namespace heartservo::sim
