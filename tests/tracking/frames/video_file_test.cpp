#include "tracking/frames/video_file.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "tests/support/analytic_image.hpp"
#include "tests/support/files.hpp"
#include "tracking/frames/frame.hpp"
#include "tracking/frames/open_source.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tracking {
namespace {

using test::TemporaryFolder;

constexpr int FRAMES = 20;

// Frame k is grey level 10 k all over.
std::string write_video(const TemporaryFolder& folder, const std::string& name, double rate_hz) {
  cv::VideoWriter writer(folder / name, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), rate_hz, cv::Size(64, 48));
  for (int k = 0; k < FRAMES; ++k) writer.write(cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(10 * k)));
  return folder / name;
}

TEST(VideoFile, EveryFrameInOrderAtItsOwnRate) {
  const TemporaryFolder folder;
  const auto source = open_source(write_video(folder, "heart.avi", 50), 0);
  EXPECT_EQ(source->size(), cv::Size(64, 48));
  EXPECT_DOUBLE_EQ(source->frame_rate_hz(), 50);
  EXPECT_EQ(source->frame_count(), static_cast<std::size_t>(FRAMES));
  std::vector<Frame> frames;
  for (Frame frame; source->next(frame);) frames.push_back(frame);
  ASSERT_EQ(frames.size(), static_cast<std::size_t>(FRAMES));
  for (int k = 0; k < FRAMES; ++k) {
    EXPECT_EQ(frames[k].status, FrameStatus::OK);
    EXPECT_EQ(frames[k].sequence, static_cast<std::uint64_t>(k));
    EXPECT_DOUBLE_EQ(frames[k].time_s, k / 50.0);
    EXPECT_EQ(frames[k].colour.type(), CV_8UC3);
    EXPECT_NEAR(cv::mean(frames[k].grey)[0], 10 * k, 3) << "kept frames are not overwritten by later ones";
  }
}

TEST(VideoFile, AGivenRateOverridesTheFiles) {
  const TemporaryFolder folder;
  const auto source = open_video_file(write_video(folder, "heart.mkv", 50), 125);
  Frame frame;
  source->next(frame);
  source->next(frame);
  EXPECT_DOUBLE_EQ(frame.time_s, 0.008);
}

TEST(VideoFile, WhatIsNoVideoIsAnErrorNamingItInSilence) {
  const TemporaryFolder folder;
  const std::string whole = test::read_all(write_video(folder, "whole.avi", 50));
  std::string noise(5000, '\0');
  for (std::size_t i = 0; i < noise.size(); ++i) noise[i] = static_cast<char>(i * i * 31 + i / 7);
  for (const std::string& file :
       {folder / "absent.avi", folder.write("empty.avi", ""), folder.write("text.avi", "no video\n"),
        folder.write("letters.txt", "FFmpeg would play this as a video\n"), folder.write("noise.mp4", noise),
        folder.write("cut.avi", whole.substr(0, 2000))}) {
    testing::internal::CaptureStderr();
    try {
      open_source(file, 0);
      ADD_FAILURE() << file << " was accepted";
    } catch (const InputError& e) {
      EXPECT_NE(std::string(e.what()).find(file), std::string::npos) << e.what();
    }
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << file;
  }
}

TEST(VideoFile, ACutOffVideoEndsWhereItIsCut) {
  const TemporaryFolder folder;
  {
    cv::VideoWriter writer(folder / "whole.avi", cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 50, cv::Size(320, 240));
    cv::Mat frame;
    cv::cvtColor(test::analytic_image(320, 240), frame, cv::COLOR_GRAY2BGR);
    for (int k = 0; k < FRAMES; ++k) writer.write(frame);
  }
  const std::string whole = test::read_all(folder / "whole.avi");
  const auto source = open_source(folder.write("cut.avi", whole.substr(0, whole.size() / 2)), 0);
  int frames = 0;
  for (Frame frame; source->next(frame);) ++frames;
  EXPECT_GT(frames, FRAMES / 4);
  EXPECT_LT(frames, FRAMES);
}

}  // namespace
}  // namespace heartservo::tracking
