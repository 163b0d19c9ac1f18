#include "tracking/texture/first_order_features.hpp"

#include <cmath>

namespace heartservo::tracking {

FirstOrderFeatures first_order_features(const LevelHistogram& histogram) {
  FirstOrderFeatures f{};
  double n = 0;
  for (int i = 0; i < histogram.levels; ++i) {
    const double c = histogram.counts[static_cast<std::size_t>(i)];
    n += c;
    f.mean += (i + 1) * c;
  }
  if (n <= 0) return {};
  f.mean /= n;
  double third = 0, fourth = 0;
  for (int i = 0; i < histogram.levels; ++i) {
    const double p = histogram.counts[static_cast<std::size_t>(i)] / n, t = i + 1 - f.mean;
    if (p <= 0) continue;
    f.variance += t * t * p;
    third += t * t * t * p;
    fourth += t * t * t * t * p;
    f.energy += p * p;
    f.entropy -= p * std::log2(p);
  }
  f.skewness = f.variance > 0 ? third / (f.variance * std::sqrt(f.variance)) : 0;
  f.kurtosis = f.variance > 0 ? fourth / (f.variance * f.variance) : 1;
  return f;
}

}  // namespace heartservo::tracking
