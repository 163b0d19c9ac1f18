#include "tracking/landmark/print_refinement.hpp"

#include <gtest/gtest.h>

#include "tests/support/table2_camera.hpp"
#include "tests/tracking/landmark/plate_scene.hpp"

namespace heartservo::tracking {
namespace {

using test::SIDE;
using test::table2_camera;

// Side of the picture, px: what tells the distance.
double size_px(const Quad& quad) { return std::sqrt(area(quad)); }

TEST(PrintRefinement, CornersOutwardByAFifthOfAPixelTellTheRightDistanceAgain) {
  auto random = test::seeded();
  const LandmarkTemplate plate(test::wavy_plate(), test::kPlateBlur);
  for (int k = 0; k < 10; ++k) {
    const auto T = test::tilted_pose(random, 0.4, 0.055);
    const Quad truth = project_square(table2_camera(), T, SIDE);
    const cv::Mat grey = test::plate_picture(random, table2_camera(), plate, T, test::some_light(), 3);
    Quad outward = truth;
    const Eigen::Vector2d middle = 0.25 * (truth[0] + truth[1] + truth[2] + truth[3]);
    for (auto& corner : outward) corner += 0.2 * (corner - middle).normalized();
    const Quad found = refine_by_print(grey, table2_camera(), outward, test::wavy_plate(), SIDE);
    EXPECT_NEAR(size_px(found) / size_px(truth), 1, 8e-4);
    EXPECT_GT(std::abs(size_px(outward) / size_px(truth) - 1), 3e-3);
    for (int i = 0; i < 4; ++i) EXPECT_LT((found[i] - truth[i]).norm(), 0.1);
  }
}

TEST(PrintRefinement, AnotherPlateOrNoneLeavesTheCorners) {
  auto random = test::seeded();
  const auto T = test::tilted_pose(random, 0.4, 0.055);
  const Quad truth = project_square(table2_camera(), T, SIDE);
  const cv::Mat flat(512, 512, CV_8UC1, cv::Scalar(90));
  EXPECT_EQ(refine_by_print(flat, table2_camera(), truth, test::wavy_plate(), SIDE), truth);
  EXPECT_EQ(refine_by_print(flat, table2_camera(), truth, {}, SIDE), truth);
  EXPECT_EQ(refine_by_print({}, table2_camera(), truth, test::wavy_plate(), SIDE), truth);
}

}  // namespace
}  // namespace heartservo::tracking
