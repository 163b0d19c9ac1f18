#include "tracking/planar/deformable_aligner.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "tests/support/analytic_image.hpp"
#include "tests/support/numeric_jacobian.hpp"
#include "tests/support/random.hpp"
#include "tracking/planar/bend_equations.hpp"
#include "tracking/planar/quad.hpp"
#include "tracking/planar/sl3.hpp"

namespace heartservo::tracking {
namespace {

constexpr int kWidth = 320, kHeight = 260, kSide = 80;
const Quad kRegion = rectangle(120, 90, kSide, kSide);
const Eigen::Vector2d kCentre(160, 130);

Camera pixels() {
  Camera camera;
  camera.fx = camera.fy = 1;
  return camera;
}

ImagePyramid pyramid_of(const cv::Mat& image) {
  ImagePyramid pyramid;
  pyramid.build(image, cv::Rect(0, 0, image.cols, image.rows), 3);
  return pyramid;
}

// A bump that pushes tissue to the right and down by up to `px`, 30 px wide, beside the region's centre: no homography.
Eigen::Vector2d bump(const Eigen::Vector2d& at, double px) {
  const Eigen::Vector2d from = at - kCentre - Eigen::Vector2d(8, -5);
  return px * std::exp(-from.squaredNorm() / (2 * 30.0 * 30.0)) * Eigen::Vector2d(0.9, 0.5);
}

// What the bump makes of the analytic picture: the pixel at x + bump(x) shows what was at x.
cv::Mat bumped(double px, double shading = 0) {
  cv::Mat image(kHeight, kWidth, CV_8UC1);
  for (int v = 0; v < kHeight; ++v)
    for (int u = 0; u < kWidth; ++u) {
      Eigen::Vector2d x(u, v);
      for (int i = 0; i < 30; ++i) x = Eigen::Vector2d(u, v) - bump(x, px);
      const double shade = 1 + shading * std::sin(0.05 * (u - kCentre.x())) * std::cos(0.04 * (v - kCentre.y()));
      image.at<std::uint8_t>(v, u) = cv::saturate_cast<std::uint8_t>(0.9 * shade * test::analytic_grey(x.x(), x.y()));
    }
  return image;
}

struct Fixture {
  std::unique_ptr<PatchAligner> aligner = make_deformable_aligner({});
  Alignment start;
  Fixture() {
    start.G_plane_patch = to_sl3(homography_between(rectangle(-1, -1, 2, 2), kRegion));
    cv::Mat image(kHeight, kWidth, CV_8UC1);
    for (int v = 0; v < kHeight; ++v)
      for (int u = 0; u < kWidth; ++u)
        image.at<std::uint8_t>(v, u) = cv::saturate_cast<std::uint8_t>(0.9 * test::analytic_grey(u, v));
    aligner->learn(pyramid_of(image), pixels(), start.G_plane_patch, kSide, kSide);
  }
  // As a tracker would: from frame to frame.
  Alignment follow(double px, double shading = 0, const cv::Rect& glare = {}) {
    Alignment a = start;
    for (int k = 1; k <= 4; ++k) {
      cv::Mat image = bumped(px * k / 4, shading * k / 4);
      if (!glare.empty()) image(glare).setTo(255);
      a = aligner->align(pyramid_of(image), a, 2, MotionModel::HOMOGRAPHY);
    }
    return a;
  }
  Eigen::Vector2d found(const Alignment& a, const Eigen::Vector2d& at) const {
    const Eigen::Vector2d patch = (at - kCentre) / (kSide / 2);
    return (a.G_plane_patch * aligner->bent(a, patch).homogeneous()).hnormalized();
  }
  double worst_inside(const Alignment& a, double px) const {
    double worst = 0;
    for (int v = -30; v <= 30; v += 10)
      for (int u = -30; u <= 30; u += 10) {
        const Eigen::Vector2d at = kCentre + Eigen::Vector2d(u, v);
        worst = std::max(worst, (found(a, at) - at - bump(at, px)).norm());
      }
    return worst;
  }
};

TEST(DeformableAligner, FollowsABumpThatNoHomographyFollows) {
  Fixture f;
  const Alignment a = f.follow(5);
  ASSERT_TRUE(a.converged);
  EXPECT_GT(a.correlation, 0.999);
  EXPECT_LT((f.found(a, kCentre) - kCentre - bump(kCentre, 5)).norm(), 0.05);
  EXPECT_LT(f.worst_inside(a, 5), 0.25);
  // the homography is that of the centre: where the bent region's centre lies
  EXPECT_LT(((a.G_plane_patch * Eigen::Vector3d::UnitZ()).hnormalized() - f.found(a, kCentre)).norm(), 1e-9);
}

TEST(DeformableAligner, ShadingThatVariesOverTheRegionDoesNotMoveIt) {
  Fixture f;
  const Alignment a = f.follow(3, 0.2);
  ASSERT_TRUE(a.converged);
  EXPECT_LT((f.found(a, kCentre) - kCentre - bump(kCentre, 3)).norm(), 0.1);
  EXPECT_LT(f.worst_inside(a, 3), 0.4);
  EXPECT_GT(a.correlation, 0.995);
}

TEST(DeformableAligner, BridgesGlareSmoothly) {
  Fixture f;
  const Alignment a = f.follow(3, 0, cv::Rect(140, 110, 22, 22));
  ASSERT_TRUE(a.converged);
  EXPECT_LT(a.visible, 0.95);
  EXPECT_LT((f.found(a, {150, 120}) - Eigen::Vector2d(150, 120) - bump({150, 120}, 3)).norm(), 0.5);  // under it
}

TEST(DeformableAligner, IsNotPulledByATool) {
  Fixture f;
  Alignment a = f.start;
  for (int k = 1; k <= 4; ++k) {
    cv::Mat image = bumped(0.75 * k);
    image(cv::Rect(125, 95, 40, 38)).setTo(15);
    a = f.aligner->align(pyramid_of(image), a, 1, MotionModel::HOMOGRAPHY);
  }
  ASSERT_TRUE(a.converged);
  EXPECT_LT(a.visible, 0.85);
  EXPECT_LT((f.found(a, {180, 150}) - Eigen::Vector2d(180, 150) - bump({180, 150}, 3)).norm(), 0.2);
}

TEST(DeformableAligner, SaysSoWhenTheRegionLeavesThePictureOrIsPlain) {
  Fixture f;
  Alignment start = f.start;
  start.G_plane_patch = homography_between(rectangle(-1, -1, 2, 2), rectangle(600, 500, kSide, kSide));
  EXPECT_FALSE(f.aligner->align(pyramid_of(bumped(0)), start, 2, MotionModel::HOMOGRAPHY).converged);
  start.G_plane_patch.setConstant(std::nan(""));
  EXPECT_FALSE(f.aligner->align(pyramid_of(bumped(0)), start, 2, MotionModel::HOMOGRAPHY).converged);
  const Alignment plain = f.aligner->align(pyramid_of(cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar(90))), f.start, 2,
                                           MotionModel::HOMOGRAPHY);
  EXPECT_FALSE(plain.converged && plain.correlation > 0.3);
}

// The normal equations against central differences of the closed-form residual, where template and picture agree.
TEST(BendEquations, AreThoseOfTheResidual) {
  const ImagePyramid pyramid = pyramid_of(test::analytic_image(kWidth, kHeight));
  const Eigen::Matrix3d G = to_sl3(homography_between(rectangle(-1, -1, 2, 2), rectangle(140, 110, 40, 40)));
  const Patch patch = make_patch(pyramid.level(0), pixels(), G, 41, 41);
  BentGrid grid(bend_of(40, 40, 14), patch);
  const int points = grid.spline().points();
  AlignmentBuffers buffers;
  buffers.resize(patch.size());
  const BentPoints bent = grid.bend(BendField::Zero(3, points));
  warp(pyramid.level(0), pixels(), G, patch, Interpolation::CUBIC, buffers.grey.data(), nullptr, bent);
  AlignmentPass pass;
  weigh_points(simd::EsmTemplate(patch), {1, 0, bent.gain_offset}, buffers, pass);
  BendEquations equations;
  equations.resize(points);
  equations.JtJ.setZero();
  equations.Jtr.setZero();
  add_bend_pass(patch, {1, 0, bent.gain_offset}, grid, buffers, equations);

  const auto residual = [&](const Eigen::VectorXd& d) {
    const BendField field = Eigen::Map<const Eigen::Matrix3Xd>(d.data(), 3, points);
    Eigen::VectorXd r = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(patch.size()));
    for (int row = 0; row < patch.height; ++row)
      for (int column = 0; column < patch.width; ++column) {
        const int i = row * patch.width + column;
        const Eigen::Vector2d x(patch.x_of(column), patch.y_of(row));
        const Eigen::Vector2d p = (G * (x + grid.spline().offset(field, x)).homogeneous()).hnormalized();
        const double weight = static_cast<double>(buffers.weight[static_cast<std::size_t>(i)]);
        r(i) = std::sqrt(weight) *
               ((1 + grid.spline().gain_offset(field, x)) * test::analytic_grey(p.x(), p.y()) + d(3 * points));
      }
    return r;
  };
  const Eigen::MatrixXd J = test::numeric_jacobian(residual, Eigen::VectorXd::Zero(3 * points + 1), 1e-5);
  const Eigen::MatrixXd JtJ = J.transpose() * J;
  // a gradient over two pixels is up to 2.3 % below the derivative; 8 bits add to it where a cell has little texture
  for (int i = 0; i < JtJ.rows(); ++i)
    for (int j = 0; j <= i; ++j)
      EXPECT_NEAR(equations.JtJ(i, j), JtJ(i, j), 0.08 * std::sqrt(JtJ(i, i) * JtJ(j, j)) + 1e-9) << i << ", " << j;
}

}  // namespace
}  // namespace heartservo::tracking
