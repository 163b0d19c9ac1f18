#include "tracking/texture/matrices.hpp"

#include <gtest/gtest.h>

#include "tests/support/random.hpp"
#include "tests/tracking/texture/texture_support.hpp"

namespace heartservo::tracking {
namespace {

using test::level_image;
using test::Rows;

TextureMatrices build(const LevelImage& image, unsigned directions = ALL_DIRECTIONS, int distance = 1) {
  TextureMatrices m;
  MatrixBuilder().build(image.region(), distance, m, directions);
  return m;
}

Rows pairs(const TextureMatrices& m) {
  Rows rows;
  for (int i = 0; i < m.pairs.levels; ++i) rows.emplace_back(m.pairs.row(i), m.pairs.row(i) + m.pairs.levels);
  return rows;
}

Rows runs(const TextureMatrices& m) {
  Rows rows;
  for (int i = 0; i < m.runs.levels; ++i) rows.emplace_back(m.runs.row(i) + 1, m.runs.row(i) + m.runs.stride);
  return rows;
}

// The picture of Haralick, Shanmugam, Dinstein 1973, Fig. 3, which scikit-image's tests use too: their one-way counts
// plus their transposes are these.
TEST(CooccurrenceMatrix, IsHaralicksExampleInEachDirection) {
  const auto image = level_image(4, {{0, 0, 1, 1}, {0, 0, 1, 1}, {0, 2, 2, 2}, {2, 2, 3, 3}});
  EXPECT_EQ(pairs(build(image, DIRECTION_0)), (Rows{{4, 2, 1, 0}, {2, 4, 0, 0}, {1, 0, 6, 1}, {0, 0, 1, 2}}));
  EXPECT_EQ(pairs(build(image, DIRECTION_90)), (Rows{{6, 0, 2, 0}, {0, 4, 2, 0}, {2, 2, 2, 2}, {0, 0, 2, 0}}));
  EXPECT_EQ(pairs(build(image, DIRECTION_135)), (Rows{{2, 1, 3, 0}, {1, 2, 1, 0}, {3, 1, 0, 2}, {0, 0, 2, 0}}));
  EXPECT_EQ(pairs(build(image, DIRECTION_45)), (Rows{{4, 1, 0, 0}, {1, 2, 2, 0}, {0, 2, 4, 1}, {0, 0, 1, 0}}));
}

// The example picture of Galloway 1975 and its matrices.
TEST(RunLengthMatrix, IsGallowaysExampleInEachDirection) {
  const auto image = level_image(4, {{0, 1, 2, 3}, {0, 2, 3, 3}, {2, 1, 1, 1}, {3, 0, 3, 0}});
  EXPECT_EQ(runs(build(image, DIRECTION_0)), (Rows{{4, 0, 0, 0}, {1, 0, 1, 0}, {3, 0, 0, 0}, {3, 1, 0, 0}}));
  EXPECT_EQ(runs(build(image, DIRECTION_90)), (Rows{{2, 1, 0, 0}, {4, 0, 0, 0}, {3, 0, 0, 0}, {3, 1, 0, 0}}));
  EXPECT_EQ(runs(build(image, DIRECTION_45)), (Rows{{4, 0, 0, 0}, {4, 0, 0, 0}, {0, 0, 1, 0}, {3, 1, 0, 0}}));
  EXPECT_EQ(runs(build(image, DIRECTION_135)), (Rows{{4, 0, 0, 0}, {4, 0, 0, 0}, {3, 0, 0, 0}, {5, 0, 0, 0}}));
}

// The example of the PyRadiomics and Nyxus manuals ("Gray Level Run Length Matrix"), levels 1..5, 0 degrees.
TEST(RunLengthMatrix, IsTheManualsExample) {
  const auto image =
      level_image(5, {{4, 1, 4, 3, 3}, {2, 2, 2, 0, 2}, {1, 0, 0, 0, 2}, {3, 1, 1, 1, 2}, {2, 4, 2, 2, 1}});
  EXPECT_EQ(runs(build(image, DIRECTION_0)),
            (Rows{{1, 0, 1, 0, 0}, {3, 0, 1, 0, 0}, {4, 1, 1, 0, 0}, {1, 1, 0, 0, 0}, {3, 0, 0, 0, 0}}));
}

TEST(TextureMatrices, CountEveryPixelPairAndRun) {
  auto random = test::seeded();
  for (const auto [width, height, levels, distance] : {std::array{40, 40, 32, 1},
                                                       {17, 31, 5, 3},
                                                       {5, 60, 64, 4},
                                                       {12, 12, 2, 7},
                                                       {1, 9, 3, 1},
                                                       {9, 1, 3, 2},
                                                       {3, 3, 4, 5}}) {
    const auto image = test::random_levels(random, width, height, levels);
    TextureMatrices built, plain;
    MatrixBuilder().build(image.region(), distance, built);
    test::count_plainly(image.region(), distance, plain);
    EXPECT_TRUE(built == plain) << width << " x " << height << ", " << levels << " levels, distance " << distance;
  }
}

TEST(TextureMatrices, AddUpOverDirections) {
  auto random = test::seeded();
  const auto image = test::random_levels(random, 21, 14, 6);
  Rows pair_sum(6, std::vector<std::uint32_t>(6, 0)), run_sum(6, std::vector<std::uint32_t>(21, 0));
  for (const unsigned direction : {DIRECTION_0, DIRECTION_45, DIRECTION_90, DIRECTION_135}) {
    const auto m = build(image, direction);
    for (std::size_t i = 0; i < 6; ++i) {
      for (std::size_t j = 0; j < 6; ++j) pair_sum[i][j] += pairs(m)[i][j];
      for (std::size_t n = 0; n < 21; ++n) run_sum[i][n] += runs(m)[i][n];
    }
  }
  EXPECT_EQ(pair_sum, pairs(build(image)));
  EXPECT_EQ(run_sum, runs(build(image)));
}

TEST(TextureMatrices, LeaveOutMarkedPixels) {
  constexpr std::uint8_t kOut = 2;  // = levels
  const auto m = build(level_image(2, {{0, 0, kOut, 0}}), DIRECTION_0);
  EXPECT_EQ(pairs(m), (Rows{{2, 0}, {0, 0}}));
  EXPECT_EQ(runs(m), (Rows{{1, 1, 0, 0}, {0, 0, 0, 0}})) << "a left-out pixel cuts the run";
  EXPECT_EQ(m.histogram.counts[0], 3u);
}

TEST(TextureMatrices, ReuseTheirMemory) {
  auto random = test::seeded();
  MatrixBuilder builder;
  TextureMatrices m, plain;
  builder.build(test::random_levels(random, 40, 40, 32).region(), 1, m);
  const void* before[] = {m.pairs.counts.data(), m.runs.counts.data(), m.histogram.counts.data()};
  const auto small = test::random_levels(random, 13, 22, 16);
  builder.build(small.region(), 2, m);
  const void* after[] = {m.pairs.counts.data(), m.runs.counts.data(), m.histogram.counts.data()};
  EXPECT_TRUE(std::equal(before, before + 3, after));
  test::count_plainly(small.region(), 2, plain);
  EXPECT_TRUE(m == plain) << "something of the larger region is left";
}

}  // namespace
}  // namespace heartservo::tracking
