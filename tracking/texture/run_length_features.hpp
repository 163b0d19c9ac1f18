#pragma once
// Features of the run-length matrix. r(i, n) runs of n pixels of level i = 1 .. L; N = sum r; M = sum n r: the pixels,
// once for each direction. All zero for a matrix without runs.
//
// SRE .. RP: Galloway, "Texture analysis using gray level run lengths", CGIP 4 (1975). LGRE, HGRE: Chu, Sehgal,
// Greenleaf, "Use of gray value distribution of run lengths for texture analysis", Pattern Recogn. Lett. 11 (1990).
// The last four: Dasarathy, Holder, "Image characterizations based on joint gray level-run length distributions",
// Pattern Recogn. Lett. 12 (1991).
#include "tracking/texture/matrices.hpp"

namespace heartservo::tracking {

struct RunLengthFeatures {
  double SRE;    ///< short-run emphasis: 1/N sum r / n^2
  double LRE;    ///< long-run emphasis: 1/N sum r n^2
  double GLN;    ///< grey-level non-uniformity: 1/N sum_i (sum_n r)^2
  double RLN;    ///< run-length non-uniformity: 1/N sum_n (sum_i r)^2; ITK's differs from this, the textbook's
  double RP;     ///< run percentage, as a fraction: N / M
  double LGRE;   ///< low grey-level run emphasis: 1/N sum r / i^2
  double HGRE;   ///< high grey-level run emphasis: 1/N sum r i^2
  double SRLGE;  ///< short-run low grey-level emphasis: 1/N sum r / (i^2 n^2)
  double SRHGE;  ///< short-run high grey-level emphasis: 1/N sum r i^2 / n^2
  double LRLGE;  ///< long-run low grey-level emphasis: 1/N sum r n^2 / i^2
  double LRHGE;  ///< long-run high grey-level emphasis: 1/N sum r n^2 i^2
};

RunLengthFeatures run_length_features(const RunLengthMatrix& matrix);

/// The two that the texture vector needs, quickly: RLN and SRLGE.
std::array<double, 2> quick_run_length_features(const RunLengthMatrix& matrix);

}  // namespace heartservo::tracking
