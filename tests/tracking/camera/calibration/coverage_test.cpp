#include "tracking/camera/calibration/coverage.hpp"

#include <gtest/gtest.h>

namespace heartservo::tracking {
namespace {

TEST(PictureCoverage, CountsCellsAndNamesWhatIsMissing) {
  const auto nothing = picture_coverage(1920, 1080, {});
  EXPECT_EQ(nothing.columns, 10);
  EXPECT_EQ(nothing.rows, 6);
  EXPECT_EQ(nothing.share(), 0);
  EXPECT_EQ(nothing.missing_parts().size(), 9u);
  Corners left;
  for (int v = 0; v < 512; v += 8)
    for (int u = 0; u < 307; u += 8) left.emplace_back(u, v);
  const auto half = picture_coverage(512, 512, {left});
  EXPECT_EQ(half.columns, 10);
  EXPECT_EQ(half.rows, 10);
  EXPECT_DOUBLE_EQ(half.share(), 0.6);
  EXPECT_EQ(half.missing_parts(), (std::vector<std::string>{"top right", "right", "bottom right"}));
}

TEST(PictureCoverage, RimPixelsCountAndPointsOutsideDoNot) {
  const auto c = picture_coverage(100, 100, {{{-0.5, -0.5}, {99.4, 99.4}, {-1, 5}, {5, 100}}});
  EXPECT_EQ(c.at(0, 0), 1);
  EXPECT_EQ(c.at(9, 9), 1);
  EXPECT_DOUBLE_EQ(c.share(), 0.02);
}

TEST(VolumeCoverage, OfThePapersVolume) {
  const WorkingVolume volume;
  EXPECT_EQ(volume.description(), "20 x 15 x 15 mm at 55 mm");
  const auto empty = volume_coverage(volume, {{0, 0, 0.047}, {0, 0, 0.063}, {0.0101, 0, 0.055}});
  EXPECT_EQ(empty.cells, Eigen::Vector3i(4, 3, 3));
  EXPECT_EQ(empty.share(), 0);
  std::vector<Eigen::Vector3d> near;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 3; ++j) near.emplace_back(-0.0075 + 0.005 * i, -0.005 + 0.005 * j, 0.05);
  const auto slice = volume_coverage(volume, near);
  EXPECT_DOUBLE_EQ(slice.share(), 1 / 3.0);
  EXPECT_DOUBLE_EQ(slice.share_of_slice(0), 1);
  EXPECT_DOUBLE_EQ(slice.share_of_slice(2), 0);
  EXPECT_EQ(slice.at(3, 2, 0), 1);
}

}  // namespace
}  // namespace heartservo::tracking
