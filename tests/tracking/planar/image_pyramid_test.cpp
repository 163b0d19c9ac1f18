#include "tracking/planar/image_pyramid.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "tests/support/analytic_image.hpp"
#include "tracking/planar/halve.hpp"

namespace heartservo::tracking {
namespace {

ImagePyramid pyramid_of(const cv::Mat& image, double glare_grey = kSaturatedGrey) {
  ImagePyramid pyramid;
  pyramid.build(image, cv::Rect(0, 0, image.cols, image.rows), 3, glare_grey);
  return pyramid;
}

// Largest difference of level 2 to that of a picture without glare, over the pixels that are not said to be glare.
double smeared(const cv::Mat& with_glare, const cv::Mat& without, double glare_grey = kSaturatedGrey) {
  const cv::Mat a = pyramid_of(with_glare, glare_grey).level(2).image.clone();
  const cv::Mat b = pyramid_of(without).level(2).image.clone();
  cv::Mat difference;
  cv::absdiff(a, b, difference);
  difference.setTo(0, a >= kSaturatedGrey);
  double most = 0;
  cv::minMaxLoc(difference, nullptr, &most);
  return most;
}

TEST(ImagePyramid, WithoutGlareIsThatOfPyrDown) {
  const cv::Mat image = test::analytic_image(160, 120);
  const ImagePyramid pyramid = pyramid_of(image);
  cv::Mat level, difference;
  image.convertTo(level, CV_32F);
  for (int i = 0; i < 3; ++i) {
    EXPECT_LT(cv::norm(level, pyramid.level(i).floats(), cv::NORM_INF), i < 2 ? 1e-9 : 1e-4) << i;
    cv::pyrDown(level.clone(), level);
  }
}

TEST(ImagePyramid, HalvesPicturesOfAnySizeAsPyrDownDoes) {
  for (const cv::Size size : {cv::Size(1, 1), {2, 3}, {5, 4}, {7, 9}, {33, 18}, {64, 31}}) {
    const cv::Mat bytes = test::analytic_image(size.width, size.height);
    cv::Mat floats, wanted;
    bytes.convertTo(floats, CV_32F);
    cv::pyrDown(floats, wanted);
    std::vector<float> scratch;
    for (const cv::Mat& from : {bytes, floats}) {
      cv::Mat to(wanted.size(), CV_32FC1);
      halve(from, to, scratch);
      EXPECT_LT(cv::norm(to, wanted, cv::NORM_INF), 1e-4) << size;
    }
  }
}

TEST(ImagePyramid, GlareIsNotSmearedIntoCoarseLevels) {
  const cv::Mat image(120, 160, CV_8UC1, cv::Scalar(100));
  cv::Mat glary = image.clone();
  cv::circle(glary, {80, 60}, 9, cv::Scalar(255), cv::FILLED);
  EXPECT_LT(smeared(glary, image), 0.01);
  const ImagePyramid pyramid = pyramid_of(glary);
  EXPECT_EQ(pyramid.level(2).image.at<float>(15, 20), 255);  // its middle is glare on every level
  EXPECT_EQ(pyramid.level(0).floats().at<float>(60, 80), 255);
}

TEST(ImagePyramid, TheCallerSaysWhatIsGlare) {
  const cv::Mat image(120, 160, CV_8UC1, cv::Scalar(100));
  cv::Mat glary = image.clone();
  cv::circle(glary, {80, 60}, 9, cv::Scalar(200), cv::FILLED);
  EXPECT_GT(smeared(glary, image), 20);
  EXPECT_LT(smeared(glary, image, 180), 0.01);
}

}  // namespace
}  // namespace heartservo::tracking
