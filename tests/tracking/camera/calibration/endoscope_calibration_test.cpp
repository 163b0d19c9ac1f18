// The corner lists of a real stereo endoscope, and what their owners made of them.
#include <gtest/gtest.h>

#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "tests/tracking/camera/calibration/endoscope_lists.hpp"
#include "tracking/camera/calibration/board_detection.hpp"
#include "tracking/camera/calibration/calibration.hpp"

namespace heartservo::tracking {
namespace {

using namespace test::endoscope;

std::vector<double> numbers_of(const std::string& file) {
  std::ifstream in(folder() / file);
  std::vector<double> numbers;
  for (double value; in >> value;) numbers.push_back(value);
  return numbers;
}

TEST(EndoscopeCalibration, TheFlatBoardGivesTheReference) {
  SKIP_WITHOUT_DATA(folder());
  for (const std::string side : {"left", "right"}) {
    const auto c = calibrate(BOARD, 1920, 1080, 1, positions_of({side}), {BoardShape::FLAT});
    const auto K = numbers_of("calib." + side + ".intrinsic.txt"), D = numbers_of("calib." + side + ".distortion.txt");
    ASSERT_EQ(K.size(), 9u);
    ASSERT_EQ(D.size(), 4u);
    const CameraParameters p = parameters_of(c.cameras[0].camera);
    const double reference[8] = {K[0], K[4], K[2], K[5], D[0], D[1], D[2], D[3]};
    for (int k = 0; k < 8; ++k)  // theirs has the wrong corner, where there is one
      EXPECT_NEAR(p[k], reference[k], 1.5 * c.cameras[0].deviation[k]) << side << " " << CAMERA_PARAMETER_NAMES[k];
    EXPECT_LT(c.sigma_px, 0.5) << "in u and in v";
  }
}

TEST(EndoscopeCalibration, ReachesTheGoalAndSeesThatTheBoardIsBent) {
  SKIP_WITHOUT_DATA(folder());
  for (const std::string side : {"left", "right"}) {
    const auto c = calibrate(BOARD, 1920, 1080, 1, positions_of({side}));
    const auto K = numbers_of("calib." + side + ".intrinsic.txt");
    EXPECT_TRUE(c.free_board);
    EXPECT_GT(c.shape_evidence, 10);
    EXPECT_NEAR(c.board_max_m, 1.2e-4, 0.4e-4);
    EXPECT_LT(c.rms_px, 0.5);
    EXPECT_NEAR(c.cameras[0].camera.fx / K[0], 1, 0.01);
    EXPECT_NEAR(c.cameras[0].camera.fy / K[4], 1, 0.01);
  }
}

TEST(EndoscopeCalibration, BothEyesTogether) {
  SKIP_WITHOUT_DATA(folder());
  const auto c = calibrate(BOARD, 1920, 1080, 2, positions_of({"left", "right"}));
  for (std::size_t side = 0; side < 2; ++side) {
    const auto K = numbers_of(side == 0 ? "calib.left.intrinsic.txt" : "calib.right.intrinsic.txt");
    EXPECT_LT(c.cameras[side].rms_px, 0.5);
    EXPECT_NEAR(c.cameras[side].camera.fx / K[0], 1, 0.01);
    EXPECT_NEAR(c.cameras[side].camera.fy / K[4], 1, 0.01);
  }
  EXPECT_LT(c.pair_strain, 1.1);
  const auto r2l = numbers_of("calib.r2l.txt");
  EXPECT_NEAR(-1e3 * c.rig.T_right_left.translation().x(), r2l[3], 0.05) << "mm between the eyes";
  EXPECT_EQ(c.views[4][1].dropped, (std::vector<std::size_t>{57})) << "6 px away from its place in right-2520";
}

TEST(EndoscopeCalibration, FindsTheBoardInItsPictures) {
  SKIP_WITHOUT_DATA(folder());
  for (const std::string view : {"798", "1884"}) {
    const cv::Mat grey =
        cv::imread((folder() / "left" / ("left-" + view + ".gray.png")).string(), cv::IMREAD_GRAYSCALE);
    ASSERT_FALSE(grey.empty());
    const auto found = detect_board(grey, BOARD);
    ASSERT_EQ(found.problem, "");
    const auto listed = corners_of("left", view);
    const auto corners = reordered(found.corners, same_looking_orders(BOARD)[order_like(BOARD, found.corners, listed)]);
    double sum = 0;
    for (std::size_t i = 0; i < listed.size(); ++i) sum += (corners[i] - listed[i]).squaredNorm();
    EXPECT_LT(std::sqrt(sum / static_cast<double>(listed.size())), 0.25) << view;
  }
}

}  // namespace
}  // namespace heartservo::tracking
