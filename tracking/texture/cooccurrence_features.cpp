#include "tracking/texture/cooccurrence_features.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "tracking/settings/target_clones.hpp"

namespace heartservo::tracking {

namespace {

// On the stack, whatever the number of levels.
using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxLevels, kMaxLevels>;
using Line = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 2 * kMaxLevels + 1, 1>;

double entropy(double p) { return p > 0 ? -p * std::log2(p) : 0; }

double entropy(const Line& p) {
  double H = 0;
  for (const double value : p) H += entropy(value);
  return H;
}

// The marginals and the distributions of sum and difference.
struct Distributions {
  Line level, sum, difference;

  explicit Distributions(const Square& p)
      : level(Line::Zero(p.rows())), sum(Line::Zero(2 * p.rows() + 1)), difference(Line::Zero(p.rows())) {
    for (Eigen::Index j = 0; j < p.cols(); ++j)
      for (Eigen::Index i = 0; i < p.rows(); ++i) {
        level(i) += p(i, j);
        sum(i + j + 2) += p(i, j);
        difference(std::abs(i - j)) += p(i, j);
      }
  }
};

double mean(const Line& p) {
  double sum = 0;
  for (Eigen::Index k = 0; k < p.size(); ++k) sum += static_cast<double>(k) * p(k);
  return sum;
}

double central_moment(const Line& p, double centre, int order) {
  double sum = 0;
  for (Eigen::Index k = 0; k < p.size(); ++k) sum += std::pow(static_cast<double>(k) - centre, order) * p(k);
  return sum;
}

double maximal_correlation(const Square& p, const Line& level) {
  Eigen::Matrix<Eigen::Index, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxLevels, 1> there(p.rows());
  Eigen::Index n = 0;
  for (Eigen::Index i = 0; i < p.rows(); ++i)
    if (level(i) > 0) there(n++) = i;
  if (n < 2) return 1;
  Square A(n, n);
  for (Eigen::Index j = 0; j < n; ++j)
    for (Eigen::Index i = 0; i < n; ++i) A(i, j) = p(there(i), there(j)) / std::sqrt(level(there(i)) * level(there(j)));
  Eigen::SelfAdjointEigenSolver<Square> solver(A, Eigen::EigenvaluesOnly);
  const auto& values = solver.eigenvalues();  // ascending; the last is 1
  return std::min(1.0, std::max(std::abs(values(0)), std::abs(values(n - 2))));
}

}  // namespace

CooccurrenceFeatures cooccurrence_features(const CooccurrenceMatrix& matrix) {
  CooccurrenceFeatures f{};
  const int L = matrix.levels;
  Square p(L, L);
  for (int j = 0; j < L; ++j)
    for (int i = 0; i < L; ++i) p(i, j) = matrix.count(i, j);
  const double total = p.sum();
  if (total <= 0) return f;
  p /= total;

  const Distributions d(p);
  const double mu = mean(d.level);  // of levels from 0
  f.variance = central_moment(d.level, mu, 2);
  f.sum_average = mean(d.sum);
  f.sum_variance = central_moment(d.sum, f.sum_average, 2);
  f.cluster_shade = central_moment(d.sum, f.sum_average, 3);
  f.cluster_prominence = central_moment(d.sum, f.sum_average, 4);
  f.sum_entropy = entropy(d.sum);
  f.contrast = central_moment(d.difference, 0, 2);
  f.diff_variance = central_moment(d.difference, mean(d.difference), 2);
  f.diff_entropy = entropy(d.difference);
  f.energy = p.squaredNorm();
  for (int j = 0; j < L; ++j)
    for (int i = 0; i < L; ++i) {
      f.homogeneity += p(i, j) / (1 + (i - j) * (i - j));
      f.joint_entropy += entropy(p(i, j));
    }
  // (i - mu)(j - mu) = ((i + j - 2 mu)^2 - (i - j)^2) / 4 - ...: the covariance from the two variances
  const double covariance = 0.25 * (f.sum_variance - f.contrast);
  f.correlation = f.variance > 0 ? covariance / f.variance : 1;

  const double HX = entropy(d.level);  // p is symmetric: HXY1 = HXY2 = 2 H(p_x)
  f.information_1 = HX > 0 ? (f.joint_entropy - 2 * HX) / HX : 0;
  f.information_2 = std::sqrt(std::max(0.0, 1 - std::exp(-2 * (2 * HX - f.joint_entropy))));
  f.max_correlation = maximal_correlation(p, d.level);
  return f;
}

namespace {

// {sum, sum of i + j, sum of squares}, levels from 0, of the counts; they are far below 2^31, and as signed numbers
// quick to convert.
HEARTSERVO_SIMD std::array<double, 3> first_pass(const std::uint32_t* counts, int levels, int stride) {
  double total = 0, weighted = 0, squares = 0;
  for (int i = 0; i < levels; ++i) {
    const std::uint32_t* row = counts + static_cast<std::ptrdiff_t>(i) * stride;
    double row_sum = 0;
#pragma omp simd reduction(+ : row_sum, squares)
    for (int j = 0; j < levels; ++j) {
      const double c = static_cast<double>(static_cast<std::int32_t>(row[j]));
      row_sum += c;
      squares += c * c;
    }
    total += row_sum;
    weighted += 2.0 * i * row_sum;  // symmetric
  }
  return {total, weighted, squares};
}

// Sums of (i - j)^2 c, (i + j - centre)^3 c and (i + j - centre)^4 c.
HEARTSERVO_SIMD std::array<double, 3> second_pass(const std::uint32_t* counts, int levels, int stride, double centre) {
  double contrast = 0, third = 0, fourth = 0;
  for (int i = 0; i < levels; ++i) {
    const std::uint32_t* row = counts + static_cast<std::ptrdiff_t>(i) * stride;
#pragma omp simd reduction(+ : contrast, third, fourth)
    for (int j = 0; j < levels; ++j) {
      const double c = static_cast<double>(static_cast<std::int32_t>(row[j]));
      const double t = static_cast<double>(i + j) - centre, u = static_cast<double>(i - j), t2 = t * t;
      contrast += u * u * c;
      third += t2 * t * c;
      fourth += t2 * t2 * c;
    }
  }
  return {contrast, third, fourth};
}

}  // namespace

std::array<double, 4> quick_cooccurrence_features(const CooccurrenceMatrix& m) {
  const auto [total, weighted, squares] = first_pass(m.counts.data(), m.levels, m.stride);
  if (total <= 0) return {};
  const auto [contrast, third, fourth] = second_pass(m.counts.data(), m.levels, m.stride, weighted / total);
  return {squares / (total * total), contrast / total, third / total, fourth / total};
}

}  // namespace heartservo::tracking
