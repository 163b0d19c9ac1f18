// Feature formulas against hand-computed values, published values of the Image Biomarker Standardisation Initiative,
// and each other.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tests/tracking/texture/texture_support.hpp"
#include "tracking/texture/cooccurrence_features.hpp"
#include "tracking/texture/feature_bank.hpp"
#include "tracking/texture/first_order_features.hpp"
#include "tracking/texture/run_length_features.hpp"

namespace heartservo::tracking {
namespace {

CooccurrenceMatrix pairs_of(const test::Rows& counts) {
  CooccurrenceMatrix m;
  m.reset(static_cast<int>(counts.size()));
  for (std::size_t i = 0; i < counts.size(); ++i)
    for (std::size_t j = 0; j < counts.size(); ++j) m.counts[i * static_cast<std::size_t>(m.stride) + j] = counts[i][j];
  return m;
}

RunLengthMatrix runs_of(const test::Rows& counts) {
  RunLengthMatrix m;
  m.reset(static_cast<int>(counts.size()), static_cast<int>(counts[0].size()));
  for (std::size_t i = 0; i < counts.size(); ++i)
    for (std::size_t n = 0; n < counts[0].size(); ++n)
      m.counts[i * static_cast<std::size_t>(m.stride) + n + 1] = counts[i][n];
  return m;
}

// p = (3 1; 1 3) / 8 by hand: mu = 3/2, variance 1/4, p_sum = 3/8 1/4 3/8 at 2 3 4, p_diff = 3/4 1/4.
TEST(CooccurrenceFeatures, AreTheHandComputedOnesOfTwoLevels) {
  const auto f = cooccurrence_features(pairs_of({{3, 1}, {1, 3}}));
  EXPECT_DOUBLE_EQ(f.energy, 20.0 / 64);
  EXPECT_DOUBLE_EQ(f.contrast, 0.25);
  EXPECT_DOUBLE_EQ(f.correlation, 0.5);
  EXPECT_DOUBLE_EQ(f.variance, 0.25);
  EXPECT_DOUBLE_EQ(f.homogeneity, 0.75 + 0.25 / 2);
  EXPECT_DOUBLE_EQ(f.sum_average, 3);
  EXPECT_DOUBLE_EQ(f.sum_variance, 0.75);
  EXPECT_NEAR(f.sum_entropy, -0.75 * std::log2(3.0 / 8) + 0.5, 1e-14);
  EXPECT_NEAR(f.joint_entropy, -0.75 * std::log2(3.0 / 8) + 0.25 * 3, 1e-14);
  EXPECT_DOUBLE_EQ(f.diff_variance, 3.0 / 16);
  EXPECT_NEAR(f.diff_entropy, -0.75 * std::log2(0.75) + 0.5, 1e-14);
  EXPECT_NEAR(f.information_1, f.joint_entropy - 2, 1e-14);
  EXPECT_NEAR(f.information_2, std::sqrt(1 - std::exp(-2 * (2 - f.joint_entropy))), 1e-14);
  EXPECT_NEAR(f.max_correlation, 0.5, 1e-14) << "of two levels it is the correlation";
  EXPECT_NEAR(f.cluster_shade, 0, 1e-14);
  EXPECT_DOUBLE_EQ(f.cluster_prominence, 0.75);
}

// Haralick 1973, the 0 degree matrix of Fig. 3: R = 24. p's squares: 4 2 1 / 2 4 / 1 6 1 / 1 2.
TEST(CooccurrenceFeatures, AreTheHandComputedOnesOfHaralicksExample) {
  const auto f = cooccurrence_features(pairs_of({{4, 2, 1, 0}, {2, 4, 0, 0}, {1, 0, 6, 1}, {0, 0, 1, 2}}));
  EXPECT_NEAR(f.energy, (16 + 4 + 1 + 4 + 16 + 1 + 36 + 1 + 1 + 4) / 576.0, 1e-14);
  EXPECT_NEAR(f.contrast, (4 * 1 + 2 * 4 + 2 * 1) / 24.0, 1e-14);
  EXPECT_NEAR(f.homogeneity, (16 + 4 / 2.0 + 2 / 5.0 + 2 / 2.0) / 24, 1e-14);
  // mu = (7 * 1 + 6 * 2 + 8 * 3 + 3 * 4) / 24 = 55 / 24; sum i j p = 137 / 24 by adding up the 10 products
  const double mu = 55.0 / 24, square = (7 * 1 + 6 * 4 + 8 * 9 + 3 * 16) / 24.0;
  const double product = (4 * 1 + 4 * 2 + 4 * 4 + 2 * 3 + 6 * 9 + 2 * 12 + 2 * 16) / 24.0;
  EXPECT_NEAR(f.variance, square - mu * mu, 1e-13);
  EXPECT_NEAR(f.correlation, (product - mu * mu) / (square - mu * mu), 1e-13);
  EXPECT_NEAR(f.sum_average, 2 * mu, 1e-13);
}

// MathWorks' manual of graycoprops prints these for contrast, correlation, energy, homogeneity of a matrix; ours are
// symmetric, so the matrix plus its transpose is compared where that changes nothing (contrast).
TEST(CooccurrenceFeatures, HaveTheContrastOfThePublishedExample) {
  const test::Rows one_way{{0, 1, 2, 3}, {1, 1, 2, 3}, {1, 0, 2, 0}, {0, 0, 0, 3}};
  test::Rows both = one_way;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j) both[i][j] += one_way[j][i];
  EXPECT_NEAR(cooccurrence_features(pairs_of(both)).contrast, 2.8947, 5e-5);
}

TEST(CooccurrenceFeatures, OfGroupsThatNeverTouchHaveMaximalCorrelationOne) {
  EXPECT_NEAR(cooccurrence_features(pairs_of({{4, 1, 0}, {1, 2, 0}, {0, 0, 6}})).max_correlation, 1, 1e-12);
  EXPECT_NEAR(cooccurrence_features(pairs_of({{4, 4, 4}, {4, 4, 4}, {4, 4, 4}})).max_correlation, 0, 1e-12);
}

// Galloway's 0 degree matrix: 16 pixels, 13 runs: 11 of one, one of two, one of three pixels.
TEST(RunLengthFeatures, AreTheHandComputedOnesOfGallowaysExample) {
  const auto f = run_length_features(runs_of({{4, 0, 0, 0}, {1, 0, 1, 0}, {3, 0, 0, 0}, {3, 1, 0, 0}}));
  EXPECT_NEAR(f.SRE, (11 + 1 / 4.0 + 1 / 9.0) / 13, 1e-14);
  EXPECT_NEAR(f.LRE, (11 + 4 + 9) / 13.0, 1e-14);
  EXPECT_NEAR(f.GLN, (16 + 4 + 9 + 16) / 13.0, 1e-14);
  EXPECT_NEAR(f.RLN, (121 + 1 + 1) / 13.0, 1e-14);
  EXPECT_NEAR(f.RP, 13 / 16.0, 1e-14);
  EXPECT_NEAR(f.LGRE, (4 + 2 / 4.0 + 3 / 9.0 + 4 / 16.0) / 13, 1e-14);
  EXPECT_NEAR(f.HGRE, (4 + 2 * 4 + 3 * 9 + 4 * 16) / 13.0, 1e-14);
  EXPECT_NEAR(f.SRLGE, (4 + (1 + 1 / 9.0) / 4 + 3 / 9.0 + (3 + 1 / 4.0) / 16) / 13, 1e-14);
  EXPECT_NEAR(f.SRHGE, (4 + (1 + 1 / 9.0) * 4 + 3 * 9 + (3 + 1 / 4.0) * 16) / 13, 1e-14);
  EXPECT_NEAR(f.LRLGE, (4 + (1 + 9) / 4.0 + 3 / 9.0 + (3 + 4) / 16.0) / 13, 1e-14);
  EXPECT_NEAR(f.LRHGE, (4 + (1 + 9) * 4 + 3 * 9 + (3 + 4) * 16) / 13.0, 1e-14);
}

// The digital phantom of the Image Biomarker Standardisation Initiative (Zwanenburg et al., arXiv 1612.07003, CC-BY):
// 5 x 4 x 4 voxels, 0 outside its region of interest. Its reference values "3D, merged" were agreed on by many
// independent implementations. Ours build matrices of flat pictures; here the 13 directions of space fill them.
class Phantom : public testing::Test {
 protected:
  static int at(int x, int y, int z) {
    static const char* kSlices[4][4] = {{"14411", "14611", "41641", "44641"},
                                        {"14411", "11611", "01311", "44611"},
                                        {"14400", "11111", "11011", "11611"},
                                        {"14400", "11111", "11111", "11611"}};
    return x >= 0 && x < 5 && y >= 0 && y < 4 && z >= 0 && z < 4 ? kSlices[z][y][x] - '0' : 0;
  }

  template <class Action>
  static void for_each_voxel(Action&& action) {
    for (int z = 0; z < 4; ++z)
      for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 5; ++x)
          if (const int level = at(x, y, z)) action(x, y, z, level);
  }

  // One of each opposite pair of the 26 neighbours.
  template <class Action>
  static void for_each_direction(Action&& action) {
    for (int k = 14; k < 27; ++k) action(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
  }
};

TEST_F(Phantom, HasTheStandardsCooccurrenceFeatures) {
  CooccurrenceMatrix m;
  m.reset(6);
  for_each_voxel([&](int x, int y, int z, int level) {
    for_each_direction([&](int dx, int dy, int dz) {
      const int other = at(x + dx, y + dy, z + dz);
      if (other == 0) return;
      ++m.counts[static_cast<std::size_t>((level - 1) * m.stride + other - 1)];
      ++m.counts[static_cast<std::size_t>((other - 1) * m.stride + level - 1)];
    });
  });
  const auto f = cooccurrence_features(m);
  EXPECT_NEAR(f.energy, 0.291, 5e-4);
  EXPECT_NEAR(f.contrast, 5.12, 5e-3);
  EXPECT_NEAR(f.correlation, 0.183, 5e-4);
  EXPECT_NEAR(f.variance, 3.13, 5e-3);
  EXPECT_NEAR(f.homogeneity, 0.631, 5e-4);
  EXPECT_NEAR(f.sum_average, 4.3, 5e-3);
  EXPECT_NEAR(f.sum_variance, 7.41, 5e-3);
  EXPECT_NEAR(f.sum_entropy, 2.11, 5e-3);
  EXPECT_NEAR(f.joint_entropy, 2.57, 5e-3);
  EXPECT_NEAR(f.diff_variance, 3.21, 5e-3);
  EXPECT_NEAR(f.diff_entropy, 1.64, 5e-3);
  EXPECT_NEAR(f.information_1, -0.0288, 5e-5);
  EXPECT_NEAR(f.information_2, 0.269, 5e-4);
  EXPECT_NEAR(f.cluster_shade, 17.4, 0.05);
  EXPECT_NEAR(f.cluster_prominence, 147, 0.5);
  const auto quick = quick_cooccurrence_features(m);
  EXPECT_NEAR(quick[0], f.energy, 1e-12);
  EXPECT_NEAR(quick[1], f.contrast, 1e-12);
  EXPECT_NEAR(quick[2], f.cluster_shade, 1e-10);
  EXPECT_NEAR(quick[3], f.cluster_prominence, 1e-10);
}

TEST_F(Phantom, HasTheStandardsRunLengthFeatures) {
  RunLengthMatrix m;
  m.reset(6, 5);
  for_each_voxel([&](int x, int y, int z, int level) {
    for_each_direction([&](int dx, int dy, int dz) {
      if (at(x - dx, y - dy, z - dz) == level) return;
      int n = 1;
      while (at(x + n * dx, y + n * dy, z + n * dz) == level) ++n;
      ++m.counts[static_cast<std::size_t>((level - 1) * m.stride + n)];
    });
  });
  const auto f = run_length_features(m);
  EXPECT_NEAR(f.SRE, 0.729, 5e-4);
  EXPECT_NEAR(f.LRE, 2.76, 5e-3);
  EXPECT_NEAR(f.GLN, 281, 0.5);
  EXPECT_NEAR(f.RLN, 328, 0.5);
  EXPECT_NEAR(f.RP, 0.68, 5e-3);
  EXPECT_NEAR(f.LGRE, 0.607, 5e-4);
  EXPECT_NEAR(f.HGRE, 9.64, 5e-3);
  EXPECT_NEAR(f.SRLGE, 0.372, 5e-4);
  EXPECT_NEAR(f.SRHGE, 8.67, 5e-3);
  EXPECT_NEAR(f.LRLGE, 2.16, 5e-3);
  EXPECT_NEAR(f.LRHGE, 15.6, 0.05);
  const auto quick = quick_run_length_features(m);
  EXPECT_NEAR(quick[0], f.RLN, 1e-10);
  EXPECT_NEAR(quick[1], f.SRLGE, 1e-12);
}

TEST_F(Phantom, HasTheStandardsFirstOrderStatistics) {
  LevelHistogram histogram;
  histogram.reset(6);
  for_each_voxel([&](int, int, int, int level) { ++histogram.counts[static_cast<std::size_t>(level - 1)]; });
  const auto f = first_order_features(histogram);
  EXPECT_NEAR(f.mean, 2.15, 5e-3);
  EXPECT_NEAR(f.variance, 3.05, 5e-3);
  EXPECT_NEAR(f.skewness, 1.08, 5e-3);
  EXPECT_NEAR(f.kurtosis, 3 - 0.355, 5e-4) << "the standard subtracts 3";
  EXPECT_NEAR(f.entropy, 1.27, 5e-3);
  EXPECT_NEAR(f.energy, 0.512, 5e-4);
}

TEST(FeatureBank, IsFiniteForEveryRegion) {
  auto random = test::seeded();
  MatrixBuilder builder;
  TextureMatrices m;
  std::vector<LevelImage> regions{test::random_levels(random, 40, 40, 64),
                                  test::random_levels(random, 12, 30, 2),
                                  {12, 12, 32, std::vector<std::uint8_t>(144, 31)},
                                  {12, 12, 32, std::vector<std::uint8_t>(144, 32)},
                                  {1, 1, 32, {5}}};
  for (const auto& region : regions) {
    builder.build(region.region(), 1, m);
    const auto bank = feature_bank(m);
    for (std::size_t k = 0; k < bank.size(); ++k) EXPECT_TRUE(std::isfinite(bank[k])) << kFeatureNames[k].name;
  }
}

TEST(FeatureBank, HasEachNameOnceAndThePapersEight) {
  std::set<std::string_view> names;
  for (const auto& feature : kFeatureNames) names.insert(feature.name);
  EXPECT_EQ(names.size(), kFeatureCount);
  for (const std::size_t place : paper_features()) EXPECT_LT(place, kFeatureCount);
}

}  // namespace
}  // namespace heartservo::tracking
