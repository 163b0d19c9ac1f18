// The candidates of the composite tracker: eq. (10) to (14), and that the quick search is the plain one.
#include "tracking/planar/candidate_search.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "tests/support/analytic_image.hpp"
#include "tests/support/random.hpp"
#include "tracking/planar/quad.hpp"
#include "tracking/planar/sl3.hpp"

namespace heartservo::tracking {
namespace {

constexpr int kWidth = 320, kHeight = 260, kSide = 40;

Camera pixels() {
  Camera camera;
  camera.fx = camera.fy = 1;
  return camera;
}

Eigen::Matrix3d place(double x, double y) {
  return to_sl3(homography_between(rectangle(-1, -1, 2, 2), rectangle(x, y, kSide, kSide)));
}

SearchPicture searched(const cv::Mat& image) {
  SearchPicture picture;
  picture.build(image, cv::Rect(0, 0, image.cols, image.rows), CandidateSearch::kLevels);
  return picture;
}

cv::Mat moved(double x, double y, double angle = 0, double scale = 1, double gain = 1, double bias = 0) {
  const Eigen::Translation2d centre(140, 130);
  const Eigen::Affine2d A =
      Eigen::Translation2d(x, y) * centre * Eigen::Rotation2Dd(angle) * Eigen::Scaling(scale) * centre.inverse();
  return test::analytic_image(kWidth, kHeight, A.matrix(), gain, bias);
}

struct Fixture {
  CandidateSearch search;
  SearchPicture reference = searched(moved(0, 0));
  explicit Fixture(const CompositeOptions& options = {}) : search(options) {
    search.learn(reference, pixels(), place(120, 110), kSide, kSide);
  }
  const std::vector<Candidate>& find(const cv::Mat& image, double radius_px = 20) {
    now = searched(image);
    return search.around(now, place(120, 110), radius_px, {});
  }
  SearchPicture now;
};

Eigen::Vector2d centre_of(const Candidate& c) { return (c.G_plane_patch * Eigen::Vector3d::UnitZ()).hnormalized(); }

TEST(CandidateScore, TheThreeWeightingsAreThoseOfThePaper) {
  EXPECT_DOUBLE_EQ(CandidateScore(Weighting::FIXED, 0.3).gamma(0.7), 0.3);
  EXPECT_DOUBLE_EQ(CandidateScore(Weighting::EQ13, 0.3).gamma(0.7), 0.7);
  EXPECT_DOUBLE_EQ(CandidateScore(Weighting::EQ14, 0.3).gamma(0.5), std::exp(-1.0));
  EXPECT_DOUBLE_EQ(CandidateScore(Weighting::EQ14, 0.3).gamma(0), 1);
  EXPECT_DOUBLE_EQ(CandidateScore(Weighting::EQ14, 0.3).gamma(1), 0);
  EXPECT_EQ(weighting_of("eq13"), Weighting::EQ13);
  EXPECT_EQ(weighting_of("eq14"), Weighting::EQ14);
  EXPECT_EQ(weighting_of("fixed"), Weighting::FIXED);
}

TEST(CandidateScore, NormalisesTextureByTheLargestDistance) {
  std::vector<Roi> rois{{0.1, 0.5, 1, true}, {0.2, 0.25, 1, true}, {0.9, 0, 1, false}};
  CandidateScore(Weighting::FIXED, 0.25).score(rois);
  EXPECT_DOUBLE_EQ(rois[0].s, 0.75 * 0.1 + 0.25);
  EXPECT_DOUBLE_EQ(rois[1].s, 0.75 * 0.2 + 0.25 * 0.5);
  EXPECT_DOUBLE_EQ(rois[2].s, 0.75 * 0.9 + 0.25);
}

// Leaving hopeless candidates out must not change which one wins, whatever their texture.
TEST(CandidateScore, WhatIsNotComparedCouldNotHaveWon) {
  auto random = test::seeded();
  for (const Weighting weighting : {Weighting::FIXED, Weighting::EQ13, Weighting::EQ14})
    for (int trial = 0; trial < 200; ++trial) {
      const CandidateScore score(weighting, test::uniform(random, 0, 0.5));
      std::vector<Roi> rois(12);
      for (auto& roi : rois) roi.d = test::uniform(random, 0, 1);
      score.choose(rois);
      for (auto& roi : rois) roi.t = test::uniform(random, 0, 2);
      score.score(rois);
      const auto best = [](const Roi& a, const Roi& b) { return a.s < b.s; };
      const Roi winner = *std::min_element(rois.begin(), rois.end(), best);
      EXPECT_TRUE(winner.compared);
      for (const Roi& roi : rois)
        if (!roi.compared) {  // even with the most alike texture
          EXPECT_GE((1 - score.gamma(roi.d)) * roi.d, winner.s - 1e-12);
        }
    }
}

// d of every window against mean, variance and covariance taken plainly.
TEST(WindowFit, IsHalfOfOneMinusTheCorrelation) {
  const SearchPicture picture = searched(moved(1.3, -0.7, 0.05, 1.02, 0.8, 12));
  const Patch patch = make_patch(searched(moved(0, 0)).pyramid().level(0), pixels(), place(120, 110), 41, 41);
  const WindowTemplate reference(patch);
  UprightView view;
  view.shape(patch, 3);
  look(picture, 0, pixels(), place(120, 110), Interpolation::LINEAR, reference.mean, view);
  for (int y = 0; y <= 6; y += 2)
    for (int x = 0; x <= 6; ++x) {
      double n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;
      for (int row = 0; row < 41; ++row)
        for (int column = 0; column < 41; ++column) {
          const auto i = static_cast<std::size_t>(row * 41 + column);
          if (!(patch.usable[i] > 0)) continue;
          const double p =
              static_cast<double>(view.grey[static_cast<std::size_t>((row + y) * view.grid.width + column + x)]);
          const double t = static_cast<double>(patch.grey[i]);
          ++n, a += p, b += t, aa += p * p, bb += t * t, ab += p * t;
        }
      const double rho = (ab - a * b / n) / std::sqrt((aa - a * a / n) * (bb - b * b / n));
      const WindowFit fit = fit_of(reference, view, x, y);
      EXPECT_NEAR(fit.d, (1 - rho) / 2, 1e-4);
      EXPECT_NEAR(fit.light.gain, std::sqrt((bb - b * b / n) / (aa - a * a / n)), 1e-3);
    }
}

// Matrices carried from window to window give the distance that matrices made afresh give.
TEST(RoiTexture, CarriedAlongIsAsMadeAfresh) {
  const SearchPicture picture = searched(moved(2, 1));
  const Patch patch = make_patch(searched(moved(0, 0)).pyramid().level(0), pixels(), place(120, 110), 41, 41);
  const WindowTemplate reference(patch);
  UprightView own, view;
  own.shape(patch, 0);
  look(searched(moved(0, 0)), 0, pixels(), place(120, 110), Interpolation::CUBIC, reference.mean, own);
  view.shape(patch, 4);
  look(picture, 0, pixels(), place(120, 110), Interpolation::CUBIC, reference.mean, view);
  RoiTexture carried(16, own, reference.mean), afresh(16, own, reference.mean);
  carried.load(view, {0.9, 5});
  double nearest = 10;
  Eigen::Vector2i at(0, 0);
  for (int y = 0; y <= 8; ++y)
    for (int i = 0; i <= 8; ++i) {
      const int x = y % 2 == 0 ? i : 8 - i;
      afresh.load(view, {0.9, 5});
      const double t = carried.distance(x, y);
      ASSERT_EQ(t, afresh.distance(x, y)) << x << ", " << y;
      if (t < nearest) nearest = t, at = {x, y};
    }
  afresh.load(view, {});
  EXPECT_LT(afresh.distance(6, 5), 0.01);  // where it lies, in its own light
}

TEST(CandidateSearch, FindsTheRegionThatMovedTurnedAndGrewInOtherLight) {
  for (const char* weighting : {"fixed", "eq13", "eq14"}) {
    CompositeOptions options;
    options.weighting = weighting;
    Fixture f(options);
    const auto& candidates = f.find(moved(13, -9, 0.1, 1.05, 0.75, 20));
    ASSERT_FALSE(candidates.empty()) << weighting;
    EXPECT_LT((centre_of(candidates.front()) - Eigen::Vector2d(153, 121)).norm(), 2) << weighting;
    EXPECT_LT(candidates.front().roi.d, 0.05) << weighting;
    EXPECT_NEAR(candidates.front().light.gain, 1 / 0.75, 0.1) << weighting;
    EXPECT_FALSE(candidates.front().at_start);
    for (std::size_t i = 1; i < candidates.size(); ++i) EXPECT_GE(candidates[i].roi.s, candidates[i - 1].roi.s);
  }
}

TEST(CandidateSearch, ARegionThatStaysIsFoundAtTheStart) {
  Fixture f;
  const auto& candidates = f.find(moved(0.3, -0.2));
  ASSERT_FALSE(candidates.empty());
  EXPECT_TRUE(candidates.front().at_start);
  EXPECT_LT(candidates.front().roi.d, 0.01);
}

TEST(CandidateSearch, GlareIsLeftOutOfTheComparison) {
  Fixture f;
  cv::Mat image = moved(6, 4);
  image(cv::Rect(136, 124, 12, 12)).setTo(255);
  const auto& candidates = f.find(image);
  ASSERT_FALSE(candidates.empty());
  EXPECT_LT((centre_of(candidates.front()) - Eigen::Vector2d(146, 134)).norm(), 1.5);
  EXPECT_LT(candidates.front().roi.d, 0.02);
}

TEST(CandidateSearch, APlainOrSaturatedPictureHasNoGoodCandidate) {
  Fixture f;
  for (const int grey : {90, 255})
    for (const Candidate& c : f.find(cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar(grey)))) EXPECT_GE(c.roi.d, 0.5);
}

}  // namespace
}  // namespace heartservo::tracking
