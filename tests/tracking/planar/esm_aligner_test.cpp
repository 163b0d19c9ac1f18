#include "tracking/planar/esm_aligner.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "tests/support/analytic_image.hpp"
#include "tests/support/numeric_jacobian.hpp"
#include "tests/support/random.hpp"
#include "tracking/planar/normal_equations.hpp"
#include "tracking/planar/quad.hpp"
#include "tracking/planar/sl3.hpp"

namespace heartservo::tracking {
namespace {

constexpr int kSide = 80;
const Quad kRegion = rectangle(120, 90, kSide, kSide);
const Quad kPatchCorners = rectangle(-1, -1, 2, 2);

Camera pixels() {
  Camera camera;
  camera.fx = camera.fy = 1;
  return camera;
}

ImagePyramid pyramid_of(const cv::Mat& image, int levels = 3) {
  ImagePyramid pyramid;
  pyramid.build(image, cv::Rect(0, 0, image.cols, image.rows), levels);
  return pyramid;
}

Eigen::Matrix3d region_homography() { return to_sl3(homography_between(kPatchCorners, kRegion)); }

// Mean over the four corners, as planar trackers are usually compared.
double corner_error(const Alignment& a, const Eigen::Matrix3d& H) {
  const Quad found = transform(a.G_plane_patch, kPatchCorners), wanted = transform(H, kRegion);
  double sum = 0;
  for (std::size_t i = 0; i < 4; ++i) sum += (found[i] - wanted[i]).norm();
  return sum / 4;
}

struct Fixture {
  std::unique_ptr<PatchAligner> aligner = make_esm_aligner({30, 1e-4});
  Alignment start;
  Fixture() {
    start.G_plane_patch = region_homography();
    aligner->learn(pyramid_of(test::analytic_image(320, 260)), pixels(), start.G_plane_patch, kSide, kSide);
  }
};

// A homography of the picture that moves the region's corners by up to `px`.
Eigen::Matrix3d random_motion(std::mt19937_64& random, double px) {
  Quad moved = kRegion;
  for (auto& c : moved) {
    const double angle = test::uniform(random, 0, 2 * M_PI);
    c += px * Eigen::Vector2d(std::cos(angle), std::sin(angle));
  }
  return homography_between(kRegion, moved);
}

TEST(EsmAligner, ConvergesFromFivePixelsAwayToAHundredthOfAPixel) {
  auto random = test::seeded();
  Fixture f;
  double worst = 0;
  for (int i = 0; i < 50; ++i) {
    const Eigen::Matrix3d H = random_motion(random, 5);
    const Alignment a =
        f.aligner->align(pyramid_of(test::analytic_image(320, 260, H)), f.start, 2, MotionModel::HOMOGRAPHY);
    ASSERT_TRUE(a.converged);
    worst = std::max(worst, corner_error(a, H));
    EXPECT_GT(a.correlation, 0.999);
  }
  RecordProperty("worst_px", std::to_string(worst));
  EXPECT_LT(worst, 0.01);  // what remains is the rounding to 8 bits: 0.4 grey of noise on both pictures together
}

TEST(EsmAligner, EstimatesGainAndBias) {
  auto random = test::seeded();
  Fixture f;
  const Eigen::Matrix3d H = random_motion(random, 3);
  const Alignment a =
      f.aligner->align(pyramid_of(test::analytic_image(320, 260, H, 0.7, 20)), f.start, 2, MotionModel::HOMOGRAPHY);
  ASSERT_TRUE(a.converged);
  EXPECT_LT(corner_error(a, H), 0.015);
  EXPECT_NEAR(a.gain, 1 / 0.7, 0.005);
  EXPECT_NEAR(a.bias, -20 / 0.7, 0.5);
}

TEST(EsmAligner, IgnoresGlareAndAnOccludedQuarter) {
  auto random = test::seeded();
  Fixture f;
  const Eigen::Matrix3d H = random_motion(random, 3);
  cv::Mat image = test::analytic_image(320, 260, H);
  image(cv::Rect(125, 95, 40, 38)).setTo(15);
  image(cv::Rect(175, 140, 12, 9)).setTo(255);
  const Alignment a = f.aligner->align(pyramid_of(image), f.start, 1, MotionModel::HOMOGRAPHY);
  ASSERT_TRUE(a.converged);
  EXPECT_LT(corner_error(a, H), 0.1);
  EXPECT_LT(a.visible, 0.85);
}

TEST(EsmAligner, FollowsThroughADistortedCamera) {
  Camera camera;
  camera.width = camera.height = 512;
  camera.fx = 593.6, camera.fy = 594.5, camera.cx = 279.6, camera.cy = 223.7;
  camera.k1 = -0.241, camera.k2 = 0.207, camera.k3 = 0.005, camera.k4 = 0.008;
  // A plane 55 mm away, seen undistorted as the analytic picture, drawn through the lens at two places.
  const auto draw = [&](const Eigen::Vector2d& shift) {
    cv::Mat image(512, 512, CV_8UC1);
    for (int v = 0; v < 512; ++v)
      for (int u = 0; u < 512; ++u) {
        const Eigen::Vector2d p = camera.normalise(Eigen::Vector2d(u, v)) * 594.0 - shift;
        image.at<std::uint8_t>(v, u) = cv::saturate_cast<std::uint8_t>(test::analytic_grey(p.x(), p.y()));
      }
    return image;
  };
  Quad plane = rectangle(40 / 594.0, 30 / 594.0, 60 / 594.0, 60 / 594.0);
  Alignment start;
  start.G_plane_patch = to_sl3(homography_between(kPatchCorners, plane));
  const auto aligner = make_esm_aligner({30, 1e-4});
  aligner->learn(pyramid_of(draw({0, 0})), camera, start.G_plane_patch, 60, 60);
  const Eigen::Vector2d shift(7, -5);
  const Alignment a = aligner->align(pyramid_of(draw(shift)), start, 2, MotionModel::HOMOGRAPHY);
  ASSERT_TRUE(a.converged);
  const Quad found = transform(a.G_plane_patch, kPatchCorners);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_LT((found[i] - plane[i] - shift / 594).norm() * 594, 0.02);
}

// The minimised function is the residual under G exp(d); its Jacobian at the optimum is what the ESM uses there.
TEST(EsmAligner, NormalEquationsAgreeWithCentralDifferencesAtTheOptimum) {
  const cv::Mat image = test::analytic_image(320, 260);
  const ImagePyramid pyramid = pyramid_of(image, 1);
  const Eigen::Matrix3d G = region_homography();
  const Patch patch = make_patch(pyramid.level(0), pixels(), G, kSide + 1, kSide + 1);
  AlignmentBuffers buffers;
  buffers.resize(patch.size());
  const auto residual = [&](const Eigen::VectorXd& d) -> Eigen::VectorXd {
    // on the smooth function itself: the 8-bit picture would put rounding noise into a difference quotient
    const Eigen::Matrix3d M = G * sl3_exp(d.head<8>());
    Eigen::VectorXd r(static_cast<Eigen::Index>(patch.size()));
    for (int row = 0; row < patch.height; ++row)
      for (int column = 0; column < patch.width; ++column) {
        const Eigen::Vector2d p = (M * Eigen::Vector3d(patch.x_of(column), patch.y_of(row), 1)).hnormalized();
        const auto i = row * patch.width + column;
        r(i) = patch.usable[static_cast<std::size_t>(i)] > 0
                   ? (1 + d[8]) * test::analytic_grey(p.x(), p.y()) + d[9] - test::analytic_grey(0, 0)
                   : 0;
      }
    return r;
  };
  const Eigen::MatrixXd J = test::numeric_jacobian(residual, Eigen::VectorXd::Zero(10), 1e-5);
  warp(pyramid.level(0), pixels(), G, patch, Interpolation::CUBIC, buffers.grey.data(), nullptr);
  AlignmentPass pass;
  esm_pass(simd::EsmTemplate(patch), {}, buffers, pass);
  const Eigen::MatrixXd JtJ = J.transpose() * J;
  // a gradient over two pixels is up to 2.3 % (sin w / w at the shortest wavelength) below the derivative
  for (int i = 0; i < 10; ++i)
    for (int j = 0; j < 10; ++j)
      EXPECT_NEAR(pass.JtJ(i, j), JtJ(i, j), 0.06 * std::sqrt(JtJ(i, i) * JtJ(j, j))) << i << ", " << j;
}

TEST(EsmAligner, SaysSoWhenTheRegionLeavesThePicture) {
  Fixture f;
  Alignment start = f.start;
  start.G_plane_patch = homography_between(kPatchCorners, rectangle(600, 500, kSide, kSide));
  EXPECT_FALSE(
      f.aligner->align(pyramid_of(test::analytic_image(320, 260)), start, 2, MotionModel::HOMOGRAPHY).converged);
  start.G_plane_patch.setConstant(std::nan(""));
  EXPECT_FALSE(
      f.aligner->align(pyramid_of(test::analytic_image(320, 260)), start, 2, MotionModel::HOMOGRAPHY).converged);
  start = f.start;
  EXPECT_FALSE(
      f.aligner->align(pyramid_of(cv::Mat(260, 320, CV_8UC1, cv::Scalar(90))), start, 2, MotionModel::HOMOGRAPHY)
          .correlation > 0.3);
}

}  // namespace
}  // namespace heartservo::tracking
