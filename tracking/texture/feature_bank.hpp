#pragma once
// All features under one list of names: the bank that feature selection chooses from.
#include <array>
#include <string_view>

#include "tracking/texture/matrices.hpp"

namespace heartservo::tracking {

struct FeatureName {
  std::string_view name;
  std::string_view group;  ///< "co-occurrence", "run length", "first order"
};

/// Names in the order of feature_bank(). Definitions: cooccurrence_features.hpp, run_length_features.hpp,
/// first_order_features.hpp.
inline constexpr std::array<FeatureName, 33> kFeatureNames{{
    {"energy", "co-occurrence"},
    {"contrast", "co-occurrence"},
    {"correlation", "co-occurrence"},
    {"variance", "co-occurrence"},
    {"homogeneity", "co-occurrence"},
    {"sum_average", "co-occurrence"},
    {"sum_variance", "co-occurrence"},
    {"sum_entropy", "co-occurrence"},
    {"joint_entropy", "co-occurrence"},
    {"diff_variance", "co-occurrence"},
    {"diff_entropy", "co-occurrence"},
    {"information_1", "co-occurrence"},
    {"information_2", "co-occurrence"},
    {"max_correlation", "co-occurrence"},
    {"cluster_shade", "co-occurrence"},
    {"cluster_prominence", "co-occurrence"},
    {"SRE", "run length"},
    {"LRE", "run length"},
    {"GLN", "run length"},
    {"RLN", "run length"},
    {"RP", "run length"},
    {"LGRE", "run length"},
    {"HGRE", "run length"},
    {"SRLGE", "run length"},
    {"SRHGE", "run length"},
    {"LRLGE", "run length"},
    {"LRHGE", "run length"},
    {"grey_mean", "first order"},
    {"grey_variance", "first order"},
    {"skewness", "first order"},
    {"kurtosis", "first order"},
    {"grey_entropy", "first order"},
    {"grey_energy", "first order"},
}};

inline constexpr std::size_t kFeatureCount = kFeatureNames.size();
using FeatureBank = std::array<double, kFeatureCount>;

/// Every feature of the region. Finite for every region; the features' headers say what a region of one level gives.
FeatureBank feature_bank(const TextureMatrices& matrices);

/// The paper's eight (Table 1) in the bank, in the order of TextureVector.
std::array<std::size_t, 8> paper_features();

}  // namespace heartservo::tracking
