#include "tracking/texture/selection.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace heartservo::tracking {

namespace {

using Index = Eigen::Index;

bool is_constant(const Eigen::MatrixXd& values, Index column) {
  const auto c = values.col(column);
  const double low = c.minCoeff(), high = c.maxCoeff();
  return high - low <= 1e-12 * std::max(std::abs(low), std::abs(high));  // rounding is no variation
}

// The columns that vary.
std::vector<Index> varying(const FeatureTable& table) {
  std::vector<Index> columns;
  for (Index k = 0; k < table.values.cols(); ++k)
    if (!is_constant(table.values, k)) columns.push_back(k);
  return columns;
}

// F of lowering Wilks' lambda by the factor `ratio` with one more feature, `before` being in already.
double f_to_enter(const Scatter& s, double ratio, std::size_t before) {
  const double free = std::max(1.0, s.samples - s.classes - static_cast<double>(before));
  return free / std::max(1, s.classes - 1) * (1 - ratio) / std::max(ratio, 1e-12);
}

class Stepwise {
 public:
  Stepwise(const Eigen::MatrixXd& z, const Scatter& s, double max_correlation)
      : scatter_(s),
        correlation_(z.transpose() * z / static_cast<double>(z.rows())),
        limit_(max_correlation),
        redundant_with_(static_cast<std::size_t>(z.cols())) {}

  /// Columns in the order of entering, each with F and lambda.
  std::vector<RankedFeature> run() {
    std::vector<RankedFeature> ranking;
    std::vector<Index> in, open;
    for (Index k = 0; k < correlation_.cols(); ++k) open.push_back(k);
    double lambda = 1;
    while (!open.empty()) {
      auto best = open.begin();
      double least = 2;
      for (auto candidate = open.begin(); candidate != open.end(); ++candidate) {
        in.push_back(*candidate);
        if (const double value = wilks_lambda(scatter_, in); value < least) {
          least = value;
          best = candidate;
        }
        in.pop_back();
      }
      const Index entered = *best;
      ranking.push_back({static_cast<std::size_t>(entered), alone(entered),
                         f_to_enter(scatter_, least / lambda, in.size()), least, 0, std::nullopt});
      lambda = least;
      in.push_back(entered);
      open.erase(best);
      std::erase_if(open, [&](Index k) {
        if (std::abs(correlation_(k, entered)) <= limit_) return false;
        redundant_with_[static_cast<std::size_t>(k)] = static_cast<std::size_t>(entered);
        return true;
      });
    }
    append_redundant(ranking);
    return ranking;
  }

 private:
  double alone(Index k) const { return f_to_enter(scatter_, wilks_lambda(scatter_, {k}), 0); }

  void append_redundant(std::vector<RankedFeature>& ranking) const {
    const auto first = static_cast<std::ptrdiff_t>(ranking.size());
    for (std::size_t k = 0; k < redundant_with_.size(); ++k)
      if (redundant_with_[k]) ranking.push_back({k, alone(static_cast<Index>(k)), 0, 1, 0, redundant_with_[k]});
    std::stable_sort(ranking.begin() + first, ranking.end(),
                     [](const auto& a, const auto& b) { return a.F_alone > b.F_alone; });
  }

  const Scatter& scatter_;
  Eigen::MatrixXd correlation_;
  double limit_;
  std::vector<std::optional<std::size_t>> redundant_with_;
};

}  // namespace

std::string problem_of(const FeatureTable& table, const SelectionOptions& options) {
  const auto samples = table.values.rows(), features = table.values.cols();
  const auto classes = static_cast<Index>(table.classes.size());
  if (classes < 2)
    return classes == 0 ? "there are no samples"
                        : "there is one class only, '" + table.classes[0] + "'; give two or more";
  if (samples < features + classes)
    return fmt::format("{} samples are too few for {} features and {} classes; give {} or more", samples, features,
                       classes, features + classes);
  for (Index c = 0; c < classes; ++c)
    if (std::count(table.label.begin(), table.label.end(), static_cast<int>(c)) < 2)
      return fmt::format("class '{}' has fewer than two samples", table.classes[static_cast<std::size_t>(c)]);
  if (!table.values.allFinite()) return "there are values that are not finite";
  const auto usable = static_cast<int>(varying(table).size());
  if (usable < options.count)
    return fmt::format("{} of {} features are the same in every sample; {} that vary are needed", features - usable,
                       features, options.count);
  return "";
}

Selection select_features(const FeatureTable& table, const SelectionOptions& options) {
  if (const std::string why = problem_of(table, options); !why.empty()) throw std::invalid_argument(why);
  const std::vector<Index> columns = varying(table);
  const auto classes = static_cast<int>(table.classes.size());
  const Eigen::MatrixXd z = standardised(table.values(Eigen::all, columns));
  const Scatter s = scatter(z, table.label, classes, options.ridge);

  Selection result;
  for (Index k = 0; k < table.values.cols(); ++k)
    if (!std::binary_search(columns.begin(), columns.end(), k)) result.constant.push_back(static_cast<std::size_t>(k));
  result.components = principal_components(z);
  result.components_kept = result.components.components_for(options.explained);
  const Eigen::VectorXd communality = result.components.communality(result.components_kept);
  result.ranking = Stepwise(z, s, options.max_correlation).run();

  std::vector<Index> chosen;
  for (RankedFeature& ranked : result.ranking) {
    if (chosen.size() < static_cast<std::size_t>(options.count)) chosen.push_back(static_cast<Index>(ranked.feature));
    ranked.communality = communality(static_cast<Index>(ranked.feature));
    ranked.feature = static_cast<std::size_t>(columns[ranked.feature]);  // from here on as in the table
    if (ranked.redundant_with) ranked.redundant_with = static_cast<std::size_t>(columns[*ranked.redundant_with]);
  }
  result.discriminant = discriminant(s, chosen);
  result.accuracy = leave_one_out_accuracy(z, table.label, classes, chosen, options.ridge);
  for (const Index k : chosen) result.chosen.push_back(static_cast<std::size_t>(columns[static_cast<std::size_t>(k)]));
  return result;
}

SetQuality quality_of(const FeatureTable& table, const std::vector<std::size_t>& features,
                      const SelectionOptions& options) {
  std::vector<Index> columns, all;
  for (const std::size_t k : features)
    if (!is_constant(table.values, static_cast<Index>(k))) {
      all.push_back(static_cast<Index>(columns.size()));
      columns.push_back(static_cast<Index>(k));
    }
  if (columns.empty()) return {1, 0};
  const auto classes = static_cast<int>(table.classes.size());
  const Eigen::MatrixXd z = standardised(table.values(Eigen::all, columns));
  return {wilks_lambda(scatter(z, table.label, classes, options.ridge), all),
          leave_one_out_accuracy(z, table.label, classes, all, options.ridge)};
}

}  // namespace heartservo::tracking
