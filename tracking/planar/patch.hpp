#pragma once
// The template: the region's grey values on a regular grid, with the coordinates in which the alignment works.
//
// Patch coordinates (x, y): the grid's centre is (0, 0), one grid step is `step`, and the longer side spans [-1, 1],
// which keeps the eight parameters of SL(3) equally scaled. A homography G_plane_patch takes patch coordinates to the
// camera's normalised plane (undistorted); without a camera, to pixels.
#include <Eigen/Core>
#include <vector>

#include "tracking/camera/camera.hpp"
#include "tracking/planar/image_pyramid.hpp"

namespace heartservo::tracking {

/// One pyramid level of the template. Arrays are row by row, width * height.
struct Patch {
  int width = 0, height = 0;  ///< grid points
  float step = 0;             ///< patch coordinate per grid step
  std::vector<float> grey;
  std::vector<float> gradient_x, gradient_y;  ///< per unit of patch coordinate
  float template_share = 0.5F;  ///< of the template's gradient in the alignment's; the rest is the picture's
  float gradient_noise = 0;     ///< standard deviation that noise gives to gradient_x and _y
  std::vector<float> usable;    ///< 1, or 0 at the border and where the template is saturated

  std::size_t size() const { return grey.size(); }
  float x_of(int column) const { return (static_cast<float>(column) - 0.5F * static_cast<float>(width - 1)) * step; }
  float y_of(int row) const { return (static_cast<float>(row) - 0.5F * static_cast<float>(height - 1)) * step; }
};

enum class Interpolation {
  LINEAR,  ///< bilinear: fast, to come near
  CUBIC,   ///< Catmull-Rom: exact enough for a hundredth of a pixel
};

/// Where the grid's points lie instead, in patch coordinates, for a patch that is bent, and by how much the gain is
/// larger there: patch.size() of each.
struct BentPoints {
  const float *x = nullptr, *y = nullptr, *gain_offset = nullptr;
};

/// Samples the pyramid's level where `G_plane_patch` sends the grid, or the bent points where they are given. `inside`
/// is 1 where the sample lies in the window, else 0. Both have patch.size() elements. Without `inside`, `grey` is brighter
/// than any glare there.
void warp(const PyramidLevel& level, const Camera& camera, const Eigen::Matrix3d& G_plane_patch, const Patch& patch,
          Interpolation interpolation, float* grey, float* inside, const BentPoints& bent = {});

/// Where noise has as large a gradient as the texture, its products with the noise of the residual would outweigh what
/// the texture says: takes the gradients from the template smoothed by 1.2 points, and the picture's not at all. Else
/// leaves the patch alone. Sets gradient_noise.
void quieten_gradient(Patch& patch);

/// A patch of width x height points at the given level, grey values from the picture under G_plane_patch.
Patch make_patch(const PyramidLevel& level, const Camera& camera, const Eigen::Matrix3d& G_plane_patch, int width,
                 int height);
/// The same into a patch that may have memory already; `scratch` likewise.
void make_patch(const PyramidLevel& level, const Camera& camera, const Eigen::Matrix3d& G_plane_patch, int width,
                int height, Patch& patch, std::vector<float>& scratch);

}  // namespace heartservo::tracking
