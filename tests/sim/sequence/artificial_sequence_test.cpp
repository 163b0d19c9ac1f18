#include "sim/sequence/artificial_sequence.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "tests/support/files.hpp"
#include "tests/support/message.hpp"
#include "tests/support/random.hpp"
#include "tracking/frames/frame.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::sim {
namespace {

constexpr double kSigma_px = 2.5;

// Gaussian dots on black, their places given in px of the first frame.
BasePicture dots(const std::vector<Eigen::Vector2d>& places) {
  BasePicture base{cv::Mat::zeros(1664, 1664, CV_32FC1), 2};
  for (const auto& place : places) {
    const double x = 2 * (place.x() - 255.5) + 831.5, y = 2 * (place.y() - 255.5) + 831.5, sigma = 2 * kSigma_px;
    for (int j = cvFloor(y - 40); j <= cvCeil(y + 40); ++j)
      for (int i = cvFloor(x - 40); i <= cvCeil(x + 40); ++i)
        base.grey.at<float>(j, i) +=
            static_cast<float>(240 * std::exp(-(std::pow(i - x, 2) + std::pow(j - y, 2)) / (2 * sigma * sigma)));
  }
  return base;
}

// Centre of gravity of the grey around a place.
Eigen::Vector2d gravity(const cv::Mat& grey, const Eigen::Vector2d& near) {
  double sum = 0, u_sum = 0, v_sum = 0;
  for (int v = cvRound(near.y()) - 15; v <= cvRound(near.y()) + 15; ++v)
    for (int u = cvRound(near.x()) - 15; u <= cvRound(near.x()) + 15; ++u) {
      const double g = grey.at<std::uint8_t>(v, u);
      sum += g, u_sum += g * u, v_sum += g * v;
    }
  return {u_sum / sum, v_sum / sum};
}

// Without perspective a dot stays symmetric and its centre of gravity is its place.
TEST(ArtificialSequence, TruthHoldsToThreeThousandthsOfAPixel) {
  auto random = test::seeded();
  std::vector<Eigen::Vector2d> places;
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x)
      places.emplace_back(200 + 38 * x + test::uniform(random, -2, 2), 170 + 38 * y + test::uniform(random, -2, 2));
  const auto base = std::make_shared<BasePicture>(dots(places));
  for (const char* name : {"a", "d", "fast"}) {
    SequenceOptions options = SequenceOptions::named(name);
    options.noise_grey = 0;
    ArtificialSequence sequence(options, base);
    double worst = 0, sum = 0;
    Eigen::Vector2d bias(0, 0);
    tracking::Frame frame;
    for (std::size_t k = 0; k < 40; ++k) {
      ASSERT_TRUE(sequence.next(frame));
      const Eigen::Matrix3d H = sequence.H_current_reference(k);
      for (const auto& place : places) {
        const Eigen::Vector2d truth = (H * place.homogeneous()).hnormalized();
        const Eigen::Vector2d off = gravity(frame.grey, truth) - truth;
        const double error = off.norm();
        bias += off / 640;
        worst = std::max(worst, error), sum += error / 640;
      }
    }
    // Whole grey levels alone make about 0.004 px in one dot.
    EXPECT_LT(worst, 0.02) << name;
    EXPECT_LT(sum, 0.006) << name;
    EXPECT_LT(bias.norm(), 5e-4) << name;
  }
}

// The sampler alone, before rounding to grey levels, under a full homography: against the dots' closed form.
TEST(PictureSampler, FollowsAHomographyToThreeThousandthsOfAPixel) {
  const Eigen::Vector2d place(300.3, 190.6);
  const BasePicture base = dots({place});
  const PictureSampler sampler(base.grey, base.texels_per_px, {255.5, 255.5});
  for (const double t : {0.0, 11.0, 37.0, 61.0, 94.0, 133.0}) {
    const Eigen::Matrix3d H = homography_of(sequence_kind("b").view(t), {256, 225}), H_back = H.inverse();
    // Least-squares shift between the sampled picture and the closed form.
    Eigen::Matrix2d A = Eigen::Matrix2d::Zero();
    Eigen::Vector2d b = Eigen::Vector2d::Zero();
    const auto exact = [&](double u, double v) {  // of the pixel's 2 x 2 samples
      double sum = 0;
      for (const double x : {-0.25, 0.25})
        for (const double y : {-0.25, 0.25}) {
          const Eigen::Vector2d p = (H_back * Eigen::Vector3d(u + x, v + y, 1)).hnormalized() - place;
          sum += 60 * std::exp(-p.squaredNorm() / (2 * kSigma_px * kSigma_px));
        }
      return sum;
    };
    const Eigen::Vector2d middle = (H * place.homogeneous()).hnormalized();
    for (int v = cvRound(middle.y()) - 12; v <= cvRound(middle.y()) + 12; ++v) {
      float row[25];
      const int from = cvRound(middle.x()) - 12;
      sampler.row(H_back, from, v, 25, row);
      for (int i = 0; i < 25; ++i) {
        const double u = from + i;
        const Eigen::Vector2d g((exact(u + 0.01, v) - exact(u - 0.01, v)) / 0.02,
                                (exact(u, v + 0.01) - exact(u, v - 0.01)) / 0.02);
        A += g * g.transpose();
        b -= g * (static_cast<double>(row[i]) - exact(u, v));
        EXPECT_NEAR(static_cast<double>(row[i]), exact(u, v), 0.3);
      }
    }
    EXPECT_LT((A.inverse() * b).norm(), 3e-4) << t;
  }
}

TEST(PictureSampler, MirrorsBeyondTheBorderAndStaysFinite) {
  cv::Mat ramp(64, 64, CV_32FC1);
  for (int j = 0; j < 64; ++j)
    for (int i = 0; i < 64; ++i) ramp.at<float>(j, i) = static_cast<float>(i);
  const PictureSampler sampler(ramp, 1, {31.5, 31.5});
  float row[400];
  sampler.row(Eigen::Matrix3d::Identity(), -160, 20, 400, row);
  for (int u = -60; u < 120; ++u) {
    const double mirrored = u < 0 ? -u : u > 63 ? 126 - u : u;
    const bool fold = std::abs(u) <= 1 || std::abs(u - 63) <= 1;  // Catmull-Rom rounds the ramp's turn
    EXPECT_NEAR(row[u + 160], mirrored, fold ? 0.3 : 1e-3) << u;
  }
  for (const float value : row) EXPECT_TRUE(value > -1 && value < 65);
}

cv::Mat frame_of(SequenceOptions options, int k, std::shared_ptr<const BasePicture> base = nullptr) {
  ArtificialSequence sequence(options, std::move(base));
  tracking::Frame frame;
  for (int i = 0; i <= k; ++i) EXPECT_TRUE(sequence.next(frame));
  return frame.grey;
}

double difference(const cv::Mat& a, const cv::Mat& b) {
  return cv::norm(a, b, cv::NORM_L1) / static_cast<double>(a.total());
}

TEST(ArtificialSequence, DependsOnTheSeedAlone) {
  SequenceOptions options = SequenceOptions::named("cde");
  const cv::Mat first = frame_of(options, 3);
  EXPECT_EQ(difference(first, frame_of(options, 3)), 0);
  options.seed = 2;
  EXPECT_GT(difference(first, frame_of(options, 3)), 5);
}

TEST(ArtificialSequence, ThePictureDoesNotDependOnTheSide) {
  SequenceOptions options = SequenceOptions::named("c");
  const cv::Mat at_80 = frame_of(options, 2);
  options.side_px = 40;
  EXPECT_EQ(difference(at_80, frame_of(options, 2)), 0);
}

TEST(ArtificialSequence, NoiseLightAndGlareAreThoseAskedFor) {
  const auto flat = std::make_shared<BasePicture>(BasePicture{cv::Mat(800, 800, CV_32FC1, cv::Scalar(100)), 1});
  SequenceOptions options = SequenceOptions::named("e");
  options.noise_grey = 4;
  ArtificialSequence sequence(options, flat);
  tracking::Frame frame;
  for (std::size_t k = 0; k < 12; ++k) {
    ASSERT_TRUE(sequence.next(frame));
    cv::Scalar mean, deviation;
    cv::meanStdDev(frame.grey, mean, deviation);
    const double t = static_cast<double>(k);
    EXPECT_NEAR(mean[0], 100 * (1 + 0.25 * std::sin(2 * M_PI * t / 45)) + 15 * std::sin(2 * M_PI * t / 30), 0.1) << k;
    EXPECT_NEAR(deviation[0], 4, 0.1);
  }
  options = SequenceOptions::named("c");
  options.noise_grey = 0;
  ArtificialSequence glare(options, flat);
  double saturated = 0, most = 0;
  for (std::size_t k = 0; k < 151; ++k) {
    ASSERT_TRUE(glare.next(frame));
    cv::Mat mask, inside = cv::Mat::zeros(frame.grey.size(), CV_8UC1);
    const auto corners = glare.corners(k);
    for (int v = 0; v < 512; ++v)
      for (int u = 0; u < 512; ++u) {
        const Eigen::Vector2d p =
            (glare.H_current_reference(k).inverse() * Eigen::Vector3d(u, v, 1)).hnormalized() - glare.region()[0];
        inside.at<std::uint8_t>(v, u) =
            p.minCoeff() >= 0 && p.maxCoeff() < 80 && frame.grey.at<std::uint8_t>(v, u) > 250;
      }
    const double share = cv::countNonZero(inside) / tracking::area(corners);
    saturated += share / 151, most = std::max(most, share);
  }
  EXPECT_GT(saturated, 0.01);
  EXPECT_LT(saturated, 0.11);
  EXPECT_LT(most, 0.25);
}

TEST(ArtificialSequence, KeepsTheRegionInThePicture) {
  const auto small = std::make_shared<BasePicture>(BasePicture{cv::Mat(64, 64, CV_32FC1, cv::Scalar(100)), 1});
  for (const auto& kind : sequence_kinds()) {
    if (kind.patch) continue;
    for (int place = 0; place < 3; ++place) {
      SequenceOptions options = SequenceOptions::named(kind.name);
      options.side_px = 120;
      options.place = place;
      const ArtificialSequence sequence(options, small);
      for (std::size_t k = 0; k < 151; ++k)
        for (const auto& corner : sequence.corners(k))
          EXPECT_TRUE(corner.minCoeff() > 5 && corner.maxCoeff() < 506) << kind.name << " " << place << " " << k;
    }
  }
}

TEST(ArtificialSequence, LaysAPatchOverTheSimulatedHeart) {
  SequenceOptions options = SequenceOptions::named("table5");
  options.side_px = 40;
  options.frames = 30;
  const auto white = std::make_shared<BasePicture>(BasePicture{cv::Mat(1664, 1664, CV_32FC1, cv::Scalar(200)), 2});
  ArtificialSequence sequence(options, white);
  tracking::Frame frame, before;
  double changed = 0;
  for (std::size_t k = 0; k < 30; ++k) {
    ASSERT_TRUE(sequence.next(frame));
    const Eigen::Vector2d c = tracking::centre(sequence.corners(k));
    for (const double x : {-24.0, 0.0, 24.0})
      for (const double y : {-24.0, 0.0, 24.0})
        EXPECT_EQ(frame.grey.at<std::uint8_t>(cvRound(c.y() + y), cvRound(c.x() + x)), 200) << k;
    if (k > 0) changed += difference(frame.grey, before.grey);
    before = frame;
  }
  EXPECT_FALSE(sequence.next(frame));
  EXPECT_GT(changed / 29, 0.3) << "the heart beats under the patch";
}

TEST(ArtificialSequence, TakesRecordedFramesAsBackgroundAndPicturesAsTexture) {
  const test::TemporaryFolder folder;
  for (int k = 0; k < 4; ++k)
    cv::imwrite(folder / ("f" + std::to_string(k) + ".png"), cv::Mat(240, 320, CV_8UC1, cv::Scalar(10 * k)));
  cv::Mat ramp(512, 600, CV_8UC1);
  for (int j = 0; j < ramp.rows; ++j)
    for (int i = 0; i < ramp.cols; ++i) ramp.at<std::uint8_t>(j, i) = static_cast<std::uint8_t>(i / 3);
  const test::TemporaryFolder pictures;
  cv::imwrite(pictures / "ramp.pgm", ramp);

  SequenceOptions options = SequenceOptions::named("circle");
  options.background = folder.path();
  options.texture = pictures / "ramp.pgm";
  options.side_px = 40;
  options.speculars = 0;
  ArtificialSequence sequence(options);
  EXPECT_EQ(sequence.size(), cv::Size(320, 240));
  tracking::Frame frame;
  std::size_t count = 0;
  for (; sequence.next(frame); ++count) EXPECT_EQ(frame.grey.at<std::uint8_t>(5, 5), 10 * count);
  EXPECT_EQ(count, 4u) << "ends with the background";
}

TEST(ArtificialSequence, RefusesWhatItCannotMake) {
  const auto refusal = [](auto change) {
    SequenceOptions options = SequenceOptions::named("b");
    change(options);
    return test::message_of<ConfigError>([&] { ArtificialSequence sequence(options); });
  };
  EXPECT_NE(refusal([](auto& o) { o.side_px = 5; }).find("side is 5 px"), std::string::npos);
  EXPECT_NE(refusal([](auto& o) { o.place = 3; }).find("place is 3"), std::string::npos);
  EXPECT_NE(refusal([](auto& o) { o.background = "frames"; }).find("table5 and circle"), std::string::npos);
  EXPECT_NE(refusal([](auto& o) { o.texture = "retna"; }).find("did you mean 'retina'"), std::string::npos);
}

}  // namespace
}  // namespace heartservo::sim
