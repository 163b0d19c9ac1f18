#pragma once
// The inner loops of the alignment (normal_equations.hpp): residuals, robust weights, gradients and the sums that make
// up the normal equations, in one sweep over strips of eight or sixteen columns. Within a strip a lane's x is fixed, so
// that only powers of y, the same for all lanes, are multiplied point by point; those of x come once, at its end.
#include <Eigen/Core>

#include "tracking/planar/patch.hpp"
#include "tracking/planar/simd/aligned.hpp"

namespace heartservo::tracking::simd {

/// A template as the sweep reads it: of each strip, from top to bottom, a vector of grey values, of gradients along x
/// and along y (times the template's share of the mean gradient). Strips begin at column 1; rows 1 ... height - 2.
/// What is not usable has a grey value that no picture has.
struct EsmTemplate {
  int width = 0, height = 0, strips = 0, lanes = 0;
  float first_x = 0, first_y = 0, step = 0;
  float picture_share = 0.5F;  ///< of the mean gradient
  double usable = 0;           ///< number of usable points
  AlignedFloats values;

  EsmTemplate() = default;
  explicit EsmTemplate(const Patch& patch);
};

/// Eight parameters of SL(3), gain, bias.
using EsmMatrix = Eigen::Matrix<double, 10, 10>;
using EsmVector = Eigen::Matrix<double, 10, 1>;

struct EsmJob {
  const float* grey;         ///< samples, row by row; kOutside or bright where there is none. Readable kEsmPad beyond
  const float* gain_offset;  ///< the same, or null
  float gain, bias;
  float saturated;      ///< grey from which a point and its neighbours say nothing
  float inverse_scale;  ///< 1 / the residual that has no more weight
};
inline constexpr std::size_t kEsmPad = 64;

/// Median of |residual| over at most kMedianPoints usable points, evenly spread; 0 where there are none.
float median_residual(const EsmTemplate& t, const EsmJob& job, AlignedFloats& scratch);
inline constexpr std::size_t kMedianPoints = 512;

struct EsmSums {
  double points = 0, weight = 0;
  EsmVector Jtr;
};

/// Robust weights and J^T r; J^T J too where it is given. `scratch`: kept between calls.
void esm_sweep(const EsmTemplate& t, const EsmJob& job, EsmSums& sums, EsmMatrix* JtJ, AlignedFloats& scratch);

/// Sums of a = gain * picture and c = template, both above kPairOrigin, for a correlation: under the robust weights, and
/// over all usable points that are in the picture and not saturated.
inline constexpr float kPairOrigin = 128;  // squares stay small
struct PairSums {
  double n = 0, a = 0, c = 0, aa = 0, cc = 0, ac = 0;
};
void pair_sums(const EsmTemplate& t, const EsmJob& job, PairSums& believed, PairSums& all);

/// Residuals and weights point by point, row by row; neither is touched where a point is no inner one.
void weigh(const EsmTemplate& t, const EsmJob& job, EsmSums& sums, float* residual, float* weight);

}  // namespace heartservo::tracking::simd
