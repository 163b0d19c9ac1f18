#include "tracking/landmark/square_refinement.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>

#include "tests/support/random.hpp"
#include "tests/support/table2_camera.hpp"

namespace heartservo::tracking {
namespace {

constexpr double kEdge = 0.8;

// A plate (light rim, dark inside) on grey, seen under H from plate coordinates [-1, 1]^2 to the normalised plane.
// Edges are ramps one pixel wide, from the distance to the edge: supersampling would snap them to its own grid.
cv::Mat draw_plate(const Camera& camera, const Eigen::Matrix3d& H, double noise, std::mt19937_64& random) {
  cv::Mat image(camera.height, camera.width, CV_8UC1);
  const Eigen::Matrix3d inverse = H.inverse();
  const auto radius = [&](double u, double v) {
    const Eigen::Vector2d n = camera.normalise(Eigen::Vector2d(u, v));
    return (inverse * Eigen::Vector3d(n.x(), n.y(), 1)).hnormalized().cwiseAbs().maxCoeff();
  };
  for (int v = 0; v < image.rows; ++v)
    for (int u = 0; u < image.cols; ++u) {
      const double r = radius(u, v);
      const double per_px = std::hypot(radius(u + 0.05, v) - r, radius(u, v + 0.05) - r) / 0.05;
      const auto outside = [&](double edge) {
        return 0.5 * (1 + std::erf((r - edge) / per_px / (0.7 * std::sqrt(2.0))));
      };
      const double grey = 30 + outside(kEdge) * (200 - 30) + outside(1) * (110 - 200);
      image.at<std::uint8_t>(v, u) = cv::saturate_cast<std::uint8_t>(grey + test::normal(random, noise));
    }
  return image;
}

Camera small_camera() {
  Camera camera = test::table2_camera();
  camera.width = camera.height = 200;
  camera.cx = 95;
  camera.cy = 102;
  return camera;
}

struct View {
  Camera camera = small_camera();
  Quad truth, plane;
  Eigen::Matrix3d H;
  View() {
    const double s = 30 / camera.fx;
    plane = rectangle(-s, -0.9 * s, 2 * s, 1.9 * s);
    plane[1] += Eigen::Vector2d(0.1 * s, 0.15 * s);
    plane[3] += Eigen::Vector2d(-0.05 * s, 0.02 * s);
    H = homography_between(rectangle(-1, -1, 2, 2), plane);
    for (std::size_t i = 0; i < 4; ++i) truth[i] = camera.to_pixel(camera.distort(plane[i]));
  }
};

TEST(SquareRefinement, FindsTheCornersFromAPixelAwayThroughTheDistortedCamera) {
  auto random = test::seeded();
  const View view;
  for (const double noise : {0.0, 3.0}) {
    const cv::Mat image = draw_plate(view.camera, view.H, noise, random);
    for (int trial = 0; trial < 10; ++trial) {
      Quad picked = view.truth;
      for (auto& c : picked) c += Eigen::Vector2d(test::uniform(random, -1, 1), test::uniform(random, -1, 1));
      const auto r = refine_square(image, view.camera, picked, kEdge);
      ASSERT_TRUE(r.refined);
      for (std::size_t i = 0; i < 4; ++i) EXPECT_LT((r.corners[i] - view.truth[i]).norm(), 0.05) << noise;
      EXPECT_LT(r.edge_rms_px, 0.1);
    }
  }
}

TEST(SquareRefinement, GivesBackWhatItGotWhereThereIsNoPlate) {
  const View view;
  const cv::Mat flat(200, 200, CV_8UC1, cv::Scalar(90));
  const auto r = refine_square(flat, view.camera, view.truth, kEdge);
  EXPECT_FALSE(r.refined);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(r.corners[i], view.truth[i]);
}

TEST(SquareRefinement, CornersOutsideThePictureAreLeftAlone) {
  auto random = test::seeded();
  const View view;
  const cv::Mat image = draw_plate(view.camera, view.H, 0, random);
  Quad outside = view.truth;
  for (auto& c : outside) c += Eigen::Vector2d(150, 0);
  EXPECT_FALSE(refine_square(image, view.camera, outside, kEdge).refined);
  Quad nan = view.truth;
  nan[1].y() = NAN;
  EXPECT_FALSE(refine_square(image, view.camera, nan, kEdge).refined);
}

}  // namespace
}  // namespace heartservo::tracking
