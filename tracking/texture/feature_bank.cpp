#include "tracking/texture/feature_bank.hpp"

#include <algorithm>

#include "tracking/texture/cooccurrence_features.hpp"
#include "tracking/texture/first_order_features.hpp"
#include "tracking/texture/run_length_features.hpp"
#include "tracking/texture/texture_vector.hpp"

namespace heartservo::tracking {

FeatureBank feature_bank(const TextureMatrices& matrices) {
  const auto c = cooccurrence_features(matrices.pairs);
  const auto r = run_length_features(matrices.runs);
  const auto f = first_order_features(matrices.histogram);
  return {c.energy,
          c.contrast,
          c.correlation,
          c.variance,
          c.homogeneity,
          c.sum_average,
          c.sum_variance,
          c.sum_entropy,
          c.joint_entropy,
          c.diff_variance,
          c.diff_entropy,
          c.information_1,
          c.information_2,
          c.max_correlation,
          c.cluster_shade,
          c.cluster_prominence,
          r.SRE,
          r.LRE,
          r.GLN,
          r.RLN,
          r.RP,
          r.LGRE,
          r.HGRE,
          r.SRLGE,
          r.SRHGE,
          r.LRLGE,
          r.LRHGE,
          f.mean,
          f.variance,
          f.skewness,
          f.kurtosis,
          f.entropy,
          f.energy};
}

std::array<std::size_t, 8> paper_features() {
  std::array<std::size_t, 8> places{};
  for (std::size_t k = 0; k < places.size(); ++k)
    places[k] = static_cast<std::size_t>(
        std::find_if(kFeatureNames.begin(), kFeatureNames.end(),
                     [&](const FeatureName& feature) { return feature.name == kTextureNames[k]; }) -
        kFeatureNames.begin());
  return places;
}

}  // namespace heartservo::tracking
