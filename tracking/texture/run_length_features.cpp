#include "tracking/texture/run_length_features.hpp"

#include <algorithm>

#include "tracking/settings/target_clones.hpp"

namespace heartservo::tracking {

RunLengthFeatures run_length_features(const RunLengthMatrix& m) {
  RunLengthFeatures f{};
  double N = 0, M = 0;
  for (int i = 0; i < m.levels; ++i) {
    const double level_2 = (i + 1.0) * (i + 1.0);
    double of_level = 0;
    for (int n = 1; n <= m.longest; ++n) {
      const double r = m.count(i, n), n_2 = static_cast<double>(n) * n;
      of_level += r;
      M += n * r;
      f.SRE += r / n_2;
      f.LRE += r * n_2;
      f.SRLGE += r / (level_2 * n_2);
      f.SRHGE += r * level_2 / n_2;
      f.LRLGE += r * n_2 / level_2;
      f.LRHGE += r * n_2 * level_2;
    }
    N += of_level;
    f.GLN += of_level * of_level;
    f.LGRE += of_level / level_2;
    f.HGRE += of_level * level_2;
  }
  if (N <= 0) return {};
  for (int n = 1; n <= m.longest; ++n) {
    double of_length = 0;
    for (int i = 0; i < m.levels; ++i) of_length += m.count(i, n);
    f.RLN += of_length * of_length;
  }
  for (double* feature : {&f.SRE, &f.LRE, &f.GLN, &f.RLN, &f.LGRE, &f.HGRE, &f.SRLGE, &f.SRHGE, &f.LRLGE, &f.LRHGE})
    *feature /= N;
  f.RP = N / M;
  return f;
}

namespace {

constexpr int kBlock = 128;  // lengths at a time

// Adds the runs of each of `n` lengths over the levels to `of_length` and gives the sum of r / (i^2 n^2).
HEARTSERVO_SIMD double block_pass(const std::uint32_t* counts, int levels, int stride, const double* inverse_square,
                                  int n, std::uint32_t* __restrict of_length) {
  double emphasis = 0;
  for (int i = 0; i < levels; ++i) {
    const std::uint32_t* row = counts + static_cast<std::ptrdiff_t>(i) * stride;
    double of_level = 0;
#pragma omp simd reduction(+ : of_level)
    for (int k = 0; k < n; ++k) {
      of_length[k] += row[k];
      of_level += inverse_square[k] * static_cast<double>(static_cast<std::int32_t>(row[k]));
    }
    emphasis += of_level / ((i + 1.0) * (i + 1.0));
  }
  return emphasis;
}

}  // namespace

std::array<double, 2> quick_run_length_features(const RunLengthMatrix& m) {
  double N = 0, squares = 0, emphasis = 0;
  for (int first = 1; first <= m.longest; first += kBlock) {
    const int n = std::min(kBlock, m.longest + 1 - first);
    std::array<std::uint32_t, kBlock> of_length{};
    emphasis +=
        block_pass(m.counts.data() + first, m.levels, m.stride, m.inverse_square.data() + first, n, of_length.data());
    for (int k = 0; k < n; ++k) {
      const double r = of_length[static_cast<std::size_t>(k)];
      N += r;
      squares += r * r;
    }
  }
  if (N <= 0) return {};
  return {squares / N, emphasis / N};
}

}  // namespace heartservo::tracking
