#include "tracking/frames/image_folder.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "tests/support/analytic_image.hpp"
#include "tests/support/files.hpp"
#include "tracking/frames/frame.hpp"
#include "tracking/frames/open_source.hpp"
#include "tracking/frames/picture_file.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tracking {
namespace {

using test::TemporaryFolder;

std::string encoded(const std::string& extension, const cv::Mat& image) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(extension, image, bytes);
  return {bytes.begin(), bytes.end()};
}

cv::Mat grey_picture(int level = 0) { return test::analytic_image(64, 48) + level; }

cv::Mat colour_picture() {
  cv::Mat colour;
  cv::merge(std::vector<cv::Mat>{grey_picture(), grey_picture(20), grey_picture(40)}, colour);
  return colour;
}

std::vector<Frame> all_of(FrameSource& source) {
  std::vector<Frame> frames;
  for (Frame frame; source.next(frame);) frames.push_back(frame);
  return frames;
}

std::string refusal(const std::string& source) {
  try {
    open_source(source, 0);
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find(source), std::string::npos) << e.what();
    EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
    return e.what();
  }
  ADD_FAILURE() << source << " was accepted";
  return "";
}

bool has(const std::string& text, const std::string& word) { return text.find(word) != std::string::npos; }

TEST(ImageFolder, NaturalOrder) {
  const std::vector<std::string> ordered{"a", "a1", "a2", "a10", "a10b", "a010c", "a11", "b0", "b00001", "b2"};
  for (std::size_t i = 0; i < ordered.size(); ++i)
    for (std::size_t j = 0; j < ordered.size(); ++j)
      EXPECT_EQ(natural_less(ordered[i], ordered[j]), i < j) << ordered[i] << " " << ordered[j];
  EXPECT_TRUE(natural_less("img01", "img1") != natural_less("img1", "img01")) << "a strict order even of equal numbers";
}

TEST(ImageFolder, FramesComeInNaturalOrderWithTimeAndSequence) {
  const TemporaryFolder folder;
  for (const int number : {10, 9, 1, 100})
    folder.write("f" + std::to_string(number) + ".PNG", encoded(".png", grey_picture(number)));
  folder.write("notes.txt", "not a picture");
  folder.write("._f1.png", "what another system leaves behind");
  const auto source = open_image_folder(folder.path(), 50);
  EXPECT_EQ(source->size(), cv::Size(64, 48));
  EXPECT_EQ(source->frame_rate_hz(), 50);
  EXPECT_EQ(source->frame_count(), 4u);
  EXPECT_EQ(source->description(), folder.path());
  const auto frames = all_of(*source);
  ASSERT_EQ(frames.size(), 4u);
  const int numbers[] = {1, 9, 10, 100};
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(frames[i].status, FrameStatus::OK) << frames[i].note;
    EXPECT_EQ(frames[i].sequence, static_cast<std::uint64_t>(i));
    EXPECT_DOUBLE_EQ(frames[i].time_s, i / 50.0);
    EXPECT_EQ(cv::norm(frames[i].grey, grey_picture(numbers[i]), cv::NORM_INF), 0) << "the pixels of that very file";
    EXPECT_TRUE(frames[i].colour.empty());
  }
  EXPECT_EQ(open_image_folder(folder.path(), 0)->frame_rate_hz(), 25);
}

TEST(ImageFolder, ColourFillsBothAndEveryFormatIsRead) {
  for (const std::string extension : {".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".ppm", ".webp"}) {
    const TemporaryFolder folder;
    folder.write("a" + extension, encoded(extension, colour_picture()));
    Frame frame;
    ASSERT_TRUE(open_image_folder(folder.path(), 0)->next(frame));
    EXPECT_EQ(frame.status, FrameStatus::OK) << frame.note;
    EXPECT_EQ(frame.grey.type(), CV_8UC1) << extension;
    EXPECT_EQ(frame.colour.type(), CV_8UC3) << extension;
    EXPECT_EQ(frame.grey.size(), cv::Size(64, 48)) << extension;
  }
  const TemporaryFolder folder;
  folder.write("a.pgm", encoded(".pgm", grey_picture()));
  Frame frame;
  ASSERT_TRUE(open_image_folder(folder.path(), 0)->next(frame));
  EXPECT_EQ(cv::norm(frame.grey, grey_picture(), cv::NORM_INF), 0);
}

TEST(ImageFolder, SixteenBitIsScaledToEight) {
  const TemporaryFolder folder;
  folder.write("a.png", encoded(".png", cv::Mat(8, 8, CV_16UC1, cv::Scalar(0x8012))));
  Frame frame;
  ASSERT_TRUE(open_image_folder(folder.path(), 0)->next(frame));
  EXPECT_EQ(frame.grey.type(), CV_8UC1);
  EXPECT_EQ(frame.grey.at<std::uint8_t>(3, 3), 0x80);
}

TEST(ImageFolder, ABrokenPictureIsAFrameAndTheSequenceGoesOnInSilence) {
  for (const std::string extension : {".png", ".jpg", ".bmp", ".tif", ".ppm", ".webp"})
    for (const double kept : {0.0, 0.01, 0.3, 0.6, 0.95}) {
      const TemporaryFolder folder;
      const std::string whole = encoded(extension, colour_picture());
      for (const std::string name : {"1", "2", "4"}) folder.write(name + extension, whole);
      folder.write("3" + extension, whole.substr(0, static_cast<std::size_t>(whole.size() * kept)));
      testing::internal::CaptureStderr();
      const auto frames = all_of(*open_image_folder(folder.path(), 100));
      EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << extension << " " << kept;
      ASSERT_EQ(frames.size(), 4u);
      for (const int i : {0, 1, 3}) EXPECT_EQ(frames[i].status, FrameStatus::OK) << frames[i].note;
      EXPECT_EQ(frames[2].status, FrameStatus::UNREADABLE) << extension << " " << kept;
      EXPECT_TRUE(frames[2].grey.empty());
      EXPECT_TRUE(frames[2].colour.empty());
      EXPECT_TRUE(has(frames[2].note, folder / ("3" + extension))) << frames[2].note;
      EXPECT_EQ(frames[3].sequence, 3u);
      EXPECT_DOUBLE_EQ(frames[3].time_s, 0.03);
      EXPECT_EQ(frames[3].note, "");
    }
}

TEST(ImageFolder, ADamagedByteInsideAPngIsSeen) {
  const TemporaryFolder folder;
  std::string bytes = encoded(".png", grey_picture());
  folder.write("1.png", bytes);
  bytes[bytes.size() / 2] ^= 0x10;
  folder.write("2.png", bytes);
  const auto frames = all_of(*open_image_folder(folder.path(), 0));
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(frames[1].status, FrameStatus::UNREADABLE);
  EXPECT_TRUE(has(frames[1].note, "damaged"));
}

TEST(ImageFolder, AThumbnailsEndIsNotTheJpegsEnd) {
  std::string whole = encoded(".jpg", colour_picture());
  const std::string thumbnail = "\xFF\xE1" + std::string("\x00\x08", 2) + "xx\xFF\xD8\xFF\xD9";  // APP1 of 8 bytes
  whole.insert(2, thumbnail);
  EXPECT_EQ(missing_part({whole.begin(), whole.end()}), "");
  whole.resize(whole.size() * 2 / 3);
  EXPECT_NE(missing_part({whole.begin(), whole.end()}), "");
}

TEST(ImageFolder, ASizeOtherThanTheFirstGoodOnesIsUnreadable) {
  const TemporaryFolder folder;
  folder.write("0.png", "broken");
  folder.write("1.png", encoded(".png", grey_picture()));
  folder.write("2.png", encoded(".png", test::analytic_image(32, 48)));
  const auto source = open_image_folder(folder.path(), 0);
  EXPECT_EQ(source->size(), cv::Size(64, 48));
  const auto frames = all_of(*source);
  EXPECT_EQ(frames[0].status, FrameStatus::UNREADABLE);
  EXPECT_EQ(frames[1].status, FrameStatus::OK);
  EXPECT_EQ(frames[2].status, FrameStatus::UNREADABLE);
  EXPECT_TRUE(has(frames[2].note, "32 x 48") && has(frames[2].note, "64 x 48")) << frames[2].note;
}

TEST(ImageFolder, APatternStartsAtItsFirstNumberAndGapsAreUnreadableFrames) {
  const TemporaryFolder folder;
  for (const std::string name :
       {"img0007.png", "img0008.png", "img0010.png", "img00011.png", "img12.png", "img0009.jpg"})
    folder.write(name, encoded(".png", grey_picture()));
  const auto source = open_source(folder / "img%04d.png", 0);
  EXPECT_EQ(source->frame_count(), 4u);
  const auto frames = all_of(*source);
  ASSERT_EQ(frames.size(), 4u);
  for (const int i : {0, 1, 3}) EXPECT_EQ(frames[i].status, FrameStatus::OK) << frames[i].note;
  EXPECT_EQ(frames[2].status, FrameStatus::UNREADABLE);
  EXPECT_TRUE(has(frames[2].note, "img0009.png: is missing")) << frames[2].note;

  folder.write("x0.png", encoded(".png", grey_picture()));
  folder.write("x12.png", encoded(".png", grey_picture()));
  EXPECT_EQ(open_source(folder / "x%d.png", 0)->frame_count(), 13u);
  folder.write("late10001.png", encoded(".png", grey_picture()));
  EXPECT_TRUE(has(refusal(folder / "late%d.png"), "0 to 10000"));
  EXPECT_TRUE(has(refusal(folder / "none%d.png"), "0 to 10000"));
  EXPECT_TRUE(has(refusal(folder / "img%s.png"), "%04d"));
  EXPECT_TRUE(has(refusal(folder / "img%d_%d.png"), "%04d"));
}

TEST(ImageFolder, WhatCannotBeReadAtAllIsAnErrorNamingIt) {
  const TemporaryFolder folder;
  EXPECT_TRUE(has(refusal(folder.path()), "looked for png, jpg"));
  EXPECT_TRUE(has(refusal(folder / "absent"), "no such file or folder"));
  EXPECT_THROW(open_source("", 0), InputError);
  EXPECT_THROW(open_image_folder(folder / "absent", 0), InputError);
  EXPECT_THROW(open_image_folder(folder / "absent/img%d.png", 0), InputError);
  EXPECT_TRUE(has(refusal(folder.write("text.png", "this is no picture\n")), "text file"));
  folder.write("0.png", "");
  const std::string message = refusal(folder.path());
  EXPECT_TRUE(has(message, folder / "0.png")) << message;
  EXPECT_TRUE(has(message, "2 pictures")) << message;
}

TEST(ImageFolder, OnePictureIsASourceOfOneFrame) {
  const TemporaryFolder folder;
  folder.write("other.png", encoded(".png", grey_picture()));
  const auto source = open_source(folder.write("one.png", encoded(".png", grey_picture(3))), 0);
  const auto frames = all_of(*source);
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_EQ(cv::norm(frames[0].grey, grey_picture(3), cv::NORM_INF), 0);
  EXPECT_EQ(all_of(*open_source(folder.write("without_ending", encoded(".png", grey_picture())), 0)).size(), 1u);
}

TEST(ImageFolder, RealHeartSequence) {
  const auto heart = test::data("heart_invivo/left");
  SKIP_WITHOUT_DATA(heart);
  const auto source = open_source(heart.string(), 0);
  EXPECT_EQ(source->size(), cv::Size(360, 288));
  const auto frames = all_of(*source);
  EXPECT_EQ(frames.size(), 300u);
  for (const auto& frame : frames) {
    EXPECT_EQ(frame.status, FrameStatus::OK) << frame.note;
    EXPECT_FALSE(frame.colour.empty());
  }
}

}  // namespace
}  // namespace heartservo::tracking
