#include "tracking/planar/visp_aligner.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "tests/support/analytic_image.hpp"
#include "tracking/planar/quad.hpp"
#include "tracking/planar/sl3.hpp"

namespace heartservo::tracking {
namespace {

const Quad kRegion = rectangle(120, 90, 80, 80), kPatchCorners = rectangle(-1, -1, 2, 2);

// Rotation by 17 degrees, scale 1.1, perspective, about the region's centre; then `shift` px.
Eigen::Matrix3d view(double shift) {
  Eigen::Matrix3d H, centred = Eigen::Matrix3d::Identity();
  H << 1.1 * std::cos(0.3), -1.1 * std::sin(0.3), 6 + shift, 1.1 * std::sin(0.3), 1.1 * std::cos(0.3), -4 - shift, 2e-4,
      -1e-4, 1;
  centred(0, 2) = 160, centred(1, 2) = 130;
  return centred * H * centred.inverse();
}

// What ViSP starts from must be the homography it is told, in all its eight parameters: from the right place it needs
// no way, from half a pixel away a short one.
TEST(VispAligner, StartsWhereItIsTold) {
  Camera pixels;
  pixels.fx = pixels.fy = 1;
  ImagePyramid pyramid;
  const auto see = [&](PatchAligner& aligner, const cv::Mat& image) {
    pyramid.build(image, cv::Rect(0, 0, image.cols, image.rows), 2);
    aligner.see(image);
  };
  for (const VispMethod method : {VispMethod::ESM, VispMethod::IC}) {
    const auto aligner = make_visp_aligner(method);
    Alignment start;
    start.G_plane_patch = to_sl3(homography_between(kPatchCorners, kRegion));
    const Eigen::Matrix3d G_reference = start.G_plane_patch;
    const cv::Mat first = test::analytic_image(320, 260), second = test::analytic_image(320, 260, view(0));
    see(*aligner, first);
    aligner->learn(pyramid, pixels, G_reference, 80, 80);
    see(*aligner, second);
    for (const double shift : {0.0, 0.5}) {
      start.G_plane_patch = to_sl3(view(shift) * G_reference);
      const Alignment a = aligner->align(pyramid, start, 1, MotionModel::HOMOGRAPHY);
      ASSERT_TRUE(a.converged);
      EXPECT_LT(a.iterations, 25) << shift;
      const Quad found = transform(a.G_plane_patch, kPatchCorners), truth = transform(view(0), kRegion);
      for (std::size_t i = 0; i < 4; ++i) EXPECT_LT((found[i] - truth[i]).norm(), 0.05);
    }
  }
}

}  // namespace
}  // namespace heartservo::tracking
