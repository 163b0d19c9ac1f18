#pragma once
// Feature selection as the paper had it done (section 3.1): principal component analysis says what the samples vary in,
// discriminant function analysis which features tell the classes apart; redundant ones are passed over.
#include <optional>
#include <string>
#include <vector>

#include "tracking/texture/discriminant.hpp"
#include "tracking/texture/principal_components.hpp"

namespace heartservo::tracking {

struct SelectionOptions {
  int count = 8;
  double max_correlation = 0.95;  ///< a feature that correlates more with a better one is passed over
  double explained = 0.95;        ///< share of the variance that the principal components kept explain
  double ridge = 1e-4;            ///< see scatter()
};

/// Samples with class labels.
struct FeatureTable {
  std::vector<std::string> features, classes;
  Eigen::MatrixXd values;  ///< samples x features
  std::vector<int> label;  ///< of each sample, into `classes`
};

struct RankedFeature {
  std::size_t feature;  ///< into FeatureTable::features
  /// Alone: variance between classes over that within, F with classes - 1 and samples - classes degrees of freedom.
  double F_alone;
  /// When it entered, given the features ranked before it: F, and Wilks' lambda of all up to it. 0 and 1 for a feature
  /// that was passed over.
  double F_to_enter, wilks_lambda;
  double communality;                         ///< of its variance, in the principal components kept
  std::optional<std::size_t> redundant_with;  ///< passed over for this one, which ranks higher
};

struct Selection {
  std::vector<RankedFeature> ranking;  ///< best first: in the order of entering, then those passed over, by F_alone
  std::vector<std::size_t> chosen;     ///< the first `count`
  std::vector<std::size_t> constant;   ///< left out: the same value in every sample
  PrincipalComponents components;      ///< rows in the order of the features that are not constant
  Eigen::Index components_kept = 0;
  Discriminant discriminant;  ///< of the chosen
  double accuracy = 0;        ///< leave one out, of the chosen
};

/// Why the table cannot be used, or "": fewer than two classes, fewer samples than features and classes together, a
/// class with one sample, numbers that are not finite, fewer than `count` features that vary.
std::string problem_of(const FeatureTable& table, const SelectionOptions& options = {});

/// Stepwise forward by Wilks' lambda. Throws std::invalid_argument with problem_of().
Selection select_features(const FeatureTable& table, const SelectionOptions& options = {});

/// Wilks' lambda and leave-one-out accuracy of any set of features, to compare with; constant ones do not count.
struct SetQuality {
  double wilks_lambda, accuracy;
};
SetQuality quality_of(const FeatureTable& table, const std::vector<std::size_t>& features,
                      const SelectionOptions& options = {});

}  // namespace heartservo::tracking
