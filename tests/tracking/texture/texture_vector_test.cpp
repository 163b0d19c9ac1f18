#include "tracking/texture/texture_vector.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "tests/support/files.hpp"
#include "tests/tracking/texture/texture_support.hpp"
#include "tracking/texture/feature_bank.hpp"

namespace heartservo::tracking {
namespace {

GreyRegion whole(const cv::Mat& image) { return grey_region(image, {0, 0, image.cols, image.rows}); }

cv::Mat noise(std::mt19937_64& random, double mean, double sigma, int width = 40, int height = 40) {
  cv::Mat image(height, width, CV_8UC1);
  for (auto& g : cv::Mat_<std::uint8_t>(image)) g = cv::saturate_cast<std::uint8_t>(mean + test::normal(random, sigma));
  return image;
}

TEST(Quantise, DividesTheGreyRange) {
  cv::Mat image(1, 256, CV_8UC1);
  for (int g = 0; g < 256; ++g) image.at<std::uint8_t>(0, g) = static_cast<std::uint8_t>(g);
  for (const int levels : {2, 7, 32, 64}) {
    LevelImage full, own;
    quantise(whole(image), {levels, 1, "full"}, full);
    quantise(whole(image), {levels, 1, "own"}, own);
    for (int g = 0; g < 256; ++g) ASSERT_EQ(full.data[static_cast<std::size_t>(g)], levels * g / 256);
    EXPECT_EQ(full.data, own.data) << "the picture's own range is the full one";
  }
}

TEST(Quantise, SpreadsTheRegionsOwnRange) {
  const cv::Mat image = (cv::Mat_<std::uint8_t>(2, 3) << 100, 101, 102, 103, 0, 255);
  const cv::Mat usable = (cv::Mat_<std::uint8_t>(2, 3) << 1, 1, 1, 1, 0, 0);
  const GreyRegion mask = whole(usable);
  LevelImage levels;
  quantise(whole(image), {4, 1, "own"}, levels, &mask);
  EXPECT_EQ(levels.data, (std::vector<std::uint8_t>{0, 1, 2, 3, 4, 4}))
      << "left-out pixels: level 4, outside the range";
}

TEST(TextureVector, IsTheBanksEight) {
  auto random = test::seeded();
  TextureDescriber describer({});
  describer.describe(whole(noise(random, 120, 25)));
  const auto bank = feature_bank(describer.matrices());
  const auto raw = raw_texture(describer.matrices());
  for (std::size_t k = 0; k < 8; ++k) EXPECT_NEAR(raw[k], bank[paper_features()[k]], 1e-9 * std::abs(raw[k]) + 1e-12);
}

TEST(TextureVector, StaysWithinZeroAndOne) {
  auto random = test::seeded();
  std::vector<cv::Mat> images{cv::Mat::zeros(40, 40, CV_8UC1), cv::Mat(40, 40, CV_8UC1, cv::Scalar(255))};
  cv::Mat board(40, 40, CV_8UC1), half = cv::Mat::zeros(40, 40, CV_8UC1), spike = cv::Mat::zeros(40, 40, CV_8UC1);
  for (int v = 0; v < 40; ++v)
    for (int u = 0; u < 40; ++u) board.at<std::uint8_t>(v, u) = (u + v) % 2 ? 255 : 0;
  half.colRange(0, 20).setTo(255);
  spike.at<std::uint8_t>(3, 3) = 255;
  images.insert(images.end(), {board, half, spike, 255 - spike});
  for (int i = 0; i < 30; ++i)
    images.push_back(noise(random, test::uniform(random, 0, 255), test::uniform(random, 0, 120), 12 + i, 12 + 2 * i));
  for (const int levels : {2, 32, 64})
    for (const char* range : {"full", "own"}) {
      TextureDescriber describer({levels, 1, range});
      for (const auto& image : images)
        for (const double value : describer.describe(whole(image))) {
          EXPECT_GE(value, 0);
          EXPECT_LE(value, 1);
        }
    }
}

// Each raw feature and its mapped value have the same order over many regions of one size.
TEST(TextureVector, KeepsTheOrderOfEveryFeature) {
  auto random = test::seeded();
  TextureDescriber describer({});
  std::vector<TextureVector> raw, mapped;
  for (int i = 0; i < 60; ++i) {
    cv::Mat image = noise(random, test::uniform(random, 20, 230), test::uniform(random, 1, 60));
    if (i % 2) cv::GaussianBlur(image, image, {}, test::uniform(random, 0.5, 3));
    mapped.push_back(describer.describe(whole(image)));
    raw.push_back(raw_texture(describer.matrices()));
  }
  for (std::size_t k = 0; k < 8; ++k)
    for (std::size_t a = 0; a < raw.size(); ++a)
      for (std::size_t b = 0; b < raw.size(); ++b)
        if (raw[a][k] < raw[b][k] - 1e-9 * std::abs(raw[b][k])) {
          ASSERT_LT(mapped[a][k], mapped[b][k]) << kTextureNames[k];
        }
}

TEST(TextureVector, TellsTexturesApart) {
  auto random = test::seeded();
  TextureDescriber describer({});
  const auto fine = [&] { return describer.describe(whole(noise(random, 120, 20))); };
  const auto coarse = [&] {
    cv::Mat image = noise(random, 120, 50);
    cv::GaussianBlur(image, image, {}, 1);
    return describer.describe(whole(image));
  };
  const TextureVector a = fine(), b = fine(), c = coarse(), d = coarse();
  EXPECT_LT(5 * texture_distance(a, b), texture_distance(a, c));
  EXPECT_LT(2 * texture_distance(c, d), texture_distance(a, d));
  EXPECT_EQ(texture_distance(a, a), 0);
  EXPECT_DOUBLE_EQ(texture_distance({0, 0, 0, 0, 0, 0, 0, 0}, {1, 1, 1, 1, 0, 0, 0, 0}), 2);
}

TEST(TextureVector, LeavesGlareOut) {
  auto random = test::seeded();
  cv::Mat image = noise(random, 110, 15), usable(40, 40, CV_8UC1, cv::Scalar(1));
  TextureDescriber describer({});
  const auto clean = describer.describe(whole(image));
  cv::circle(image, {15, 22}, 5, 255, cv::FILLED);
  cv::circle(usable, {15, 22}, 5, 0, cv::FILLED);
  const auto glare = describer.describe(whole(image));
  const GreyRegion mask = whole(usable);
  const auto masked = describer.describe(whole(image), &mask);
  EXPECT_LT(10 * texture_distance(clean, masked), texture_distance(clean, glare));
}

TEST(TextureVector, IsStableOnTheRecordedHeart) {
  const auto folder = test::data("heart_invivo/left");
  SKIP_WITHOUT_DATA(folder);
  const cv::Mat first = cv::imread((folder / "0001.png").string(), cv::IMREAD_GRAYSCALE);
  const cv::Mat next = cv::imread((folder / "0002.png").string(), cv::IMREAD_GRAYSCALE);
  ASSERT_FALSE(first.empty() || next.empty());
  TextureDescriber describer({});
  const auto at = [&](const cv::Mat& image, int x, int y) {
    return describer.describe(grey_region(image, {x, y, 40, 40}));
  };
  // At the points C, B, A of the data's README; what moves 3 px from frame to frame changes less than from place to
  // place.
  const std::array<std::array<int, 2>, 3> places{{{217, 135}, {250, 117}, {257, 213}}};
  for (const auto [x, y] : places)
    for (const auto [other_x, other_y] : places)
      if (x != other_x) {
        EXPECT_LT(2 * texture_distance(at(first, x, y), at(next, x, y)),
                  texture_distance(at(first, x, y), at(next, other_x, other_y)))
            << x << ", " << y << " and " << other_x << ", " << other_y;
      }
}

}  // namespace
}  // namespace heartservo::tracking
