#pragma once
// Normal equations of the bending: how the control points of a SplineBend and the light have to change for the picture
// to look like the template.
#include <Eigen/Core>

#include "tracking/planar/bent_grid.hpp"
#include "tracking/planar/normal_equations.hpp"

namespace heartservo::tracking {

/// 3 n + 1 unknowns for n control points: x, y and gain of each point, then the bias.
struct BendEquations {
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> JtJ;  ///< the lower triangle is valid
  Eigen::VectorXd Jtr;
  void resize(int control_points);
  /// Sets what a sum or a prior may be added to: elements no more than `band` left of the diagonal, and the last row.
  void clear(int band);
};

/// How far from each other the unknowns of a spline lie that appear in one equation: three rows of control points.
int band_of(const SplineBend& spline);

/// Sums over the template with the weights and residuals that weigh_points() left in `buffers`; the gradient is the
/// mean of the picture's and the template's, as in the efficient second-order minimisation. `light` has gain offsets;
/// `equations` has the grid's size.
void add_bend_pass(const Patch& patch, const Light& light, const BentGrid& grid, const AlignmentBuffers& buffers,
                   BendEquations& equations);

}  // namespace heartservo::tracking
