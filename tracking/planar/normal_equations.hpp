#pragma once
// Residual, robust weights and normal equations of the alignment at one pyramid level, in plain float loops.
#include <Eigen/Core>
#include <vector>

#include "tracking/planar/light.hpp"
#include "tracking/planar/patch.hpp"

namespace heartservo::tracking {

/// Eight parameters of SL(3), then gain and bias.
using Matrix10d = Eigen::Matrix<double, 10, 10>;
using Vector10d = Eigen::Matrix<double, 10, 1>;

/// A residual of this many standard deviations has no weight (Tukey; 95 % efficiency on normal noise).
inline constexpr double kTukey = 4.685;
/// grey; 8-bit pictures are not better than this
inline constexpr double kSmallestNoise = 1;

/// Buffers of one alignment, kept between frames. Sized for the largest level.
struct AlignmentBuffers {
  std::vector<float> grey, inside, clear, residual, weight, sample;
  void resize(std::size_t n);
};

/// What one pass over the template finds.
struct AlignmentPass {
  Matrix10d JtJ;
  Vector10d Jtr;
  double noise_grey = 0;  ///< 1.4826 * median |residual|
  double points = 0;      ///< usable points inside the picture
  double weight = 0;      ///< sum of their robust weights
};

/// residual = gain * buffers.grey + bias - template, on usable points; Tukey weights scaled by the median absolute
/// deviation; J of the efficient second-order minimisation (Benhimane & Malis 2004): the mean of the picture's and
/// the template's gradient.
AlignmentPass esm_pass(const Patch& patch, const Light& light, AlignmentBuffers& buffers, double bound = kTukey);

/// Its first half: residuals and robust weights only. JtJ and Jtr stay unset.
void weigh_points(const Patch& patch, const Light& light, AlignmentBuffers& buffers, AlignmentPass& pass,
                  double bound = kTukey);

/// Zero-mean normalised correlation of the template and buffers.grey in that light.
struct Correlation {
  double believed = 0;  ///< under buffers.weight, as the last pass left it: glare and occlusion are left out
  double all = 0;       ///< over every usable point that is not saturated
};
Correlation correlation(const Patch& patch, const Light& light, const AlignmentBuffers& buffers);

}  // namespace heartservo::tracking
