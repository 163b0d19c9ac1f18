#pragma once
// Residual, robust weights and normal equations of the alignment at one pyramid level.
#include <Eigen/Core>
#include <vector>

#include "tracking/planar/light.hpp"
#include "tracking/planar/patch.hpp"
#include "tracking/planar/simd/esm_kernel.hpp"

namespace heartservo::tracking {

/// Eight parameters of SL(3), then gain and bias.
using Matrix10d = simd::EsmMatrix;
using Vector10d = simd::EsmVector;

/// A residual of this many standard deviations has no weight (Tukey; 95 % efficiency on normal noise).
inline constexpr double kTukey = 4.685;
/// grey; 8-bit pictures are not better than this
inline constexpr double kSmallestNoise = 1;

/// Buffers of one alignment, kept between frames. Sized for the largest level.
struct AlignmentBuffers {
  std::vector<float> grey;              ///< as warp() samples it without `inside`
  std::vector<float> residual, weight;  ///< of weigh_points() alone
  simd::AlignedFloats scratch;
  void resize(std::size_t n);
};

/// What one pass over the template finds.
struct AlignmentPass {
  Matrix10d JtJ;
  Vector10d Jtr;
  double noise_grey = 0;  ///< 1.4826 * median |residual|
  double points = 0;      ///< usable points inside the picture
  double weight = 0;      ///< sum of their robust weights
  double inverse_scale = 0;  ///< 1 / the residual without weight
};

/// residual = gain * buffers.grey + bias - template, on usable points; Tukey weights scaled by the median absolute
/// deviation; J of the efficient second-order minimisation (Benhimane & Malis 2004): the mean of the picture's and
/// the template's gradient. JtJ is left alone unless asked for.
void esm_pass(const simd::EsmTemplate& reference, const Light& light, AlignmentBuffers& buffers, AlignmentPass& pass,
              bool with_JtJ = true, double bound = kTukey);

/// Its first half: residuals and robust weights only, into the buffers; 0 at the border. JtJ and Jtr stay unset.
void weigh_points(const simd::EsmTemplate& reference, const Light& light, AlignmentBuffers& buffers,
                  AlignmentPass& pass, double bound = kTukey);

/// Zero-mean normalised correlation of the template and buffers.grey in that light.
struct Correlation {
  double believed = 0;  ///< under the weights of the pass: glare and occlusion are left out
  double all = 0;       ///< over every usable point that is not saturated
};
Correlation correlation(const simd::EsmTemplate& reference, const Light& light, const AlignmentBuffers& buffers,
                        const AlignmentPass& pass);

/// Gain and bias that bring the picture nearest to the template, over the points of a pass (null: over all that are not
/// saturated) that was made in `light`. False, and nothing done, where the picture is plain.
bool fit_light(const simd::EsmTemplate& reference, const AlignmentBuffers& buffers, const AlignmentPass* pass,
               Light& light);

}  // namespace heartservo::tracking
