#include "sim/endoscope/endoscope.hpp"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <set>

#include "tests/sim/scene_support.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::sim {
namespace {

using test::paper_camera;

HeartSurface heart(double amplitude = 1) {
  HeartMotionOptions motion;
  motion.amplitude_scale = amplitude;
  HeartSurfaceOptions options;
  options.landmarks.resize(1);
  return HeartSurface(options, HeartMotion(motion, 3, 20), 4);
}

/// Tissue for all tests: it takes a while to paint.
std::shared_ptr<const TissueTexture> tissue() {
  static const auto texture =
      std::make_shared<const TissueTexture>(TissueTexture::procedural({}, heart().options().landmarks, 9));
  return texture;
}

Endoscope endoscope(const PictureOptions& options = {}, std::uint64_t seed = 7, double amplitude = 1) {
  return Endoscope(paper_camera(), heart(amplitude), options, seed, {}, tissue());
}

cv::Mat picture(Endoscope& from, double t, std::uint64_t frame, const Eigen::Vector3d* tip = nullptr) {
  cv::Mat grey;
  if (tip == nullptr) {
    from.render(t, frame, grey);
    return grey;
  }
  const ToolPose tool(*tip);
  from.render(t, frame, grey, &tool);
  return grey;
}

bool same(const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, cv::NORM_INF) == 0; }

const Eigen::Vector3d kTip(0.004, 0.003, 0.053);

TEST(Endoscope, SameSeedGivesTheSamePictureBitForBitWhateverWasRenderedBefore) {
  Endoscope a = endoscope(), b = endoscope();
  picture(b, 2.0, 4, &kTip), picture(b, 3.3, 5);
  EXPECT_TRUE(same(picture(a, 1.1, 6, &kTip), picture(b, 1.1, 6, &kTip)));
  EXPECT_TRUE(same(picture(a, 1.2, 7), picture(b, 1.2, 7)));
}

TEST(Endoscope, PictureDoesNotDependOnTheNumberOfThreads) {
  Endoscope a = endoscope();
  const cv::Mat many = picture(a, 0.7, 1, &kTip);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_TRUE(same(many, picture(a, 0.7, 1, &kTip)));
}

TEST(Endoscope, OtherSeedsTimesAndFramesGiveOtherPictures) {
  Endoscope a = endoscope(), b = endoscope({}, 8);
  const cv::Mat reference = picture(a, 1, 1);
  EXPECT_FALSE(same(reference, picture(b, 1, 1)));
  EXPECT_FALSE(same(reference, picture(a, 1.1, 1)));
  EXPECT_FALSE(same(reference, picture(a, 1, 2)));
}

TEST(Endoscope, NoiseHasTheStatedSigmaAndIsWhite) {
  PictureOptions silent, noisy;
  silent.specular_grey = noisy.specular_grey = 0;  // no saturated pixels, whose noise is cut off
  silent.noise_grey = 0, noisy.noise_grey = 3;
  silent.bias_grey = noisy.bias_grey = 20;
  Endoscope quiet = endoscope(silent), loud = endoscope(noisy);
  cv::Mat difference, clean = picture(quiet, 1, 0), before;
  double power = 0, neighbours = 0, frames = 0;
  int count = 0;
  for (std::uint64_t frame = 0; frame < 4; ++frame) {
    cv::subtract(picture(loud, 1, frame), clean, difference, {}, CV_32F);
    power += difference.dot(difference), count += 512 * 512;
    neighbours += difference.colRange(1, 512).dot(difference.colRange(0, 511)) +
                  difference.rowRange(1, 512).dot(difference.rowRange(0, 511));
    if (frame > 0) frames += difference.dot(before);
    before = difference.clone();
  }
  EXPECT_NEAR(std::sqrt(power / count), 3, 0.1);
  EXPECT_LT(std::abs(neighbours / power), 0.02);
  EXPECT_LT(std::abs(frames / power), 0.02);
}

TEST(Endoscope, SpecularsMoveOverTheTissue) {
  PictureOptions options;
  options.noise_grey = 0;
  PictureOptions dull = options;
  dull.specular_grey = 0;
  Endoscope wet = endoscope(options), dry = endoscope(dull);
  SurfaceNodes nodes(paper_camera(), options, 1.0);
  std::vector<float> scratch(1000), row(10000);
  // The squares of 0.4 mm of tissue that shine.
  auto shining = [&](double t) {
    const cv::Mat shine = picture(wet, t, 0) - picture(dry, t, 0);
    nodes.solve(wet.surface().at(t), 0, nodes.grid().size());
    std::set<std::pair<int, int>> squares;
    for (int v = 60; v < 452; ++v) {
      nodes.grid().interpolate_row(nodes.planes(), 2, v, scratch.data(), row.data());
      for (int u = 60; u < 452; ++u)
        if (shine.at<std::uint8_t>(v, u) > 100)
          squares.emplace(cvRound(row[u] * 2500), cvRound(row[nodes.grid().padded_width() + u] * 2500));
    }
    return squares;
  };
  const auto first = shining(0.9), later = shining(2.4);
  std::size_t common = 0;
  for (const auto& square : first) common += later.count(square);
  EXPECT_GT(first.size(), 30u);
  EXPECT_GT(later.size(), 30u);
  EXPECT_LT(common, first.size() / 2);
}

TEST(Endoscope, ExtremePosesGiveFiniteSurfaces) {
  PictureOptions options;
  for (const double t : {0.0, 0.9, 5.5, 300.0}) {
    SurfaceNodes nodes(paper_camera(), options, 25600);
    nodes.solve(heart(3).at(t), 0, nodes.grid().size());
    for (int i = 0; i < nodes.grid().size() * SurfaceNodes::kChannels; ++i)
      ASSERT_TRUE(std::isfinite(nodes.planes()[i]));
  }
  Endoscope wild = endoscope({}, 1, 3);
  const Eigen::Vector3d lost(NAN, 0, 0.05), behind(0, 0, -0.05), touching(0, 0, 0.001);
  for (const Eigen::Vector3d* tip : {&lost, &behind, &touching}) EXPECT_GT(cv::mean(picture(wild, 0.9, 0, tip))[0], 20);
}

TEST(Endoscope, LightFallsOffTowardsTheEdge) {
  Endoscope a = endoscope();
  const cv::Mat grey = picture(a, 1, 0);
  const double middle = cv::mean(grey(cv::Rect(160, 160, 200, 200)))[0],
               corner = cv::mean(grey(cv::Rect(0, 0, 60, 60)))[0];
  EXPECT_GT(middle, 1.8 * corner);
  EXPECT_GT(middle, 60);
  EXPECT_LT(middle, 180);
}

TEST(Endoscope, GainAndBiasAct) {
  PictureOptions options;
  options.noise_grey = 0;
  Endoscope a = endoscope(options);
  const cv::Mat before = picture(a, 1, 0);
  a.set_light(0.5, 30);
  const cv::Mat after = picture(a, 1, 0);
  const int g = before.at<std::uint8_t>(300, 200);
  EXPECT_NEAR(after.at<std::uint8_t>(300, 200), 0.5 * (g - options.bias_grey) + 30, 1);
}

TEST(Endoscope, RefusesOptionsThatMakeNoPicture) {
  PictureOptions options;
  options.light = "moon";
  options.noise_grey = -1;
  EXPECT_EQ(options.validate().size(), 2u);
  EXPECT_THROW(endoscope(options), ConfigError);
}

}  // namespace
}  // namespace heartservo::sim
