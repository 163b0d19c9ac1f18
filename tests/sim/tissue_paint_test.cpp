#include "sim/endoscope/tissue_paint.hpp"

#include <gtest/gtest.h>

namespace heartservo::sim {
namespace {

TEST(TissueLayers, SayWhereEachMaterialIs) {
  TextureOptions options;
  options.size = 512;
  options.extent_m = 0.04;
  const TissueLayers layers = paint_tissue(options, 3);
  double low = 0, high = 0;
  for (const cv::Mat& share : {layers.fat, layers.vessel}) {
    cv::minMaxLoc(share, &low, &high);
    EXPECT_EQ(low, 0);
    EXPECT_NEAR(high, 1, 1e-6);
  }
  const cv::Mat vessel = layers.vessel > 0.9, fat = (layers.fat > 0.9) & (layers.vessel < 0.01),
                muscle = (layers.fat < 0.05) & (layers.vessel < 0.01);
  for (const cv::Mat& mask : {vessel, fat, muscle}) EXPECT_GT(cv::countNonZero(mask), 500);
  // Fat is pale and blood dark.
  const double muscle_grey = cv::mean(layers.grey, muscle)[0];
  EXPECT_GT(cv::mean(layers.grey, fat)[0], muscle_grey + 30);
  EXPECT_LT(cv::mean(layers.grey, vessel)[0], muscle_grey - 20);
}

}  // namespace
}  // namespace heartservo::sim
