#pragma once
// First-order statistics of the grey levels i = 1 .. L, p(i) = pixels of level i / pixels. Formulas as in Haralick,
// Shapiro, "Computer and Robot Vision" I (1992), chapter 9. All zero for an empty histogram.
#include "tracking/texture/matrices.hpp"

namespace heartservo::tracking {

struct FirstOrderFeatures {
  double mean;      ///< m = sum i p
  double variance;  ///< s^2 = sum (i - m)^2 p
  double skewness;  ///< sum (i - m)^3 p / s^3; 0 for one level
  double kurtosis;  ///< sum (i - m)^4 p / s^4, 3 for a normal distribution and never below 1; 1 for one level
  double entropy;   ///< - sum p log2 p, bit
  double energy;    ///< sum p^2
};

FirstOrderFeatures first_order_features(const LevelHistogram& histogram);

}  // namespace heartservo::tracking
