#pragma once
// Features of the co-occurrence matrix. p(i, j) = count(i, j) / sum of counts, levels i, j = 1 .. L; p is symmetric, so
// the marginals p_x = p_y have one mean mu and one standard deviation sigma. p_sum(k) = sum over i + j = k,
// p_diff(k) = sum over |i - j| = k. H = - sum p log2 p, with 0 log 0 = 0.
//
// f1 .. f14: Haralick, Shanmugam, Dinstein, "Textural features for image classification", IEEE Trans. SMC-3 (1973).
// Cluster shade and prominence: Conners, Trivedi, Harlow, "Segmentation of a high-resolution urban scene using texture
// operators", CVGIP 25 (1984).
#include <array>

#include "tracking/texture/matrices.hpp"

namespace heartservo::tracking {

struct CooccurrenceFeatures {
  double energy;           ///< f1, angular second moment: sum p^2
  double contrast;         ///< f2: sum (i - j)^2 p
  double correlation;      ///< f3: (sum i j p - mu^2) / sigma^2; 1 for a region of one level
  double variance;         ///< f4, sum of squares: sum (i - mu)^2 p
  double homogeneity;      ///< f5, inverse difference moment: sum p / (1 + (i - j)^2)
  double sum_average;      ///< f6: sum k p_sum(k)
  double sum_variance;     ///< f7: sum (k - f6)^2 p_sum(k); the paper prints f8 in place of f6, taken for a misprint
  double sum_entropy;      ///< f8: H of p_sum
  double joint_entropy;    ///< f9: H of p
  double diff_variance;    ///< f10: variance of k under p_diff
  double diff_entropy;     ///< f11: H of p_diff
  double information_1;    ///< f12: (H - HXY1) / H(p_x), HXY1 = - sum p log2(p_x(i) p_y(j)); 0 for one level
  double information_2;    ///< f13: sqrt(1 - exp(-2 (HXY2 - H))), HXY2 = 2 H(p_x), the entropies in bits as IBSI has it
  double max_correlation;  ///< f14, see below; 1 for a region of one level
  double cluster_shade;    ///< sum (i + j - 2 mu)^3 p
  double cluster_prominence;  ///< sum (i + j - 2 mu)^4 p
};

/// All zero for a matrix without pairs.
///
/// The maximal correlation coefficient f14 is the square root of the second largest eigenvalue of
/// Q(i, j) = sum_k p(i, k) p(j, k) / (p_x(i) p_y(k)). Libraries often leave it out as unstable, which it is when Q,
/// which is not symmetric, goes to a general eigenvalue solver. Q is similar to A^2 with the symmetric A(i, j) = p(i,
/// j) / sqrt(p_x(i) p_x(j)) over the levels that occur, so f14 is A's second largest absolute eigenvalue: the
/// self-adjoint solver gives it to machine precision. It is 1 when the levels fall into groups that never touch.
CooccurrenceFeatures cooccurrence_features(const CooccurrenceMatrix& matrix);

/// The four that the texture vector needs, quickly: energy, contrast, cluster shade, cluster prominence.
std::array<double, 4> quick_cooccurrence_features(const CooccurrenceMatrix& matrix);

}  // namespace heartservo::tracking
