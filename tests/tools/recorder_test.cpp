#include "tools/capture/recorder.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>

#include "tests/support/message.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tools/run_folder.hpp"
#include "tracking/frames/open_source.hpp"
#include "tracking/frames/recording.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::test {
namespace {

using namespace tools;
using tracking::Frame;
using tracking::FrameStatus;

constexpr int W = 64, H = 48;

cv::Mat noise(int seed, int type) {
  cv::Mat picture(H, W, type);
  cv::RNG random(static_cast<std::uint64_t>(seed));
  random.fill(picture, cv::RNG::UNIFORM, 0, 256);
  return picture;
}

Frame frame_of(int i, bool colour) {
  Frame frame;
  frame.grey = noise(i, CV_8UC1);
  if (colour) frame.colour = noise(i, CV_8UC3);
  frame.time_s = 0.02 * i + (i > 5 ? 0.013 : 0);  // no even rate
  frame.sequence = static_cast<std::uint64_t>(i > 5 ? i + 1 : i);
  if (i == 3) frame.status = FrameStatus::NOT_LIVE;
  frame.capture = tracking::CaptureStamp{1000.25 + i,
                                         frame.time_s + 0.004,
                                         frame.time_s + 0.006,
                                         true,
                                         i != 4,
                                         static_cast<std::uint32_t>(70 + i),
                                         0x12000,
                                         i == 6 ? 1u : 0u,
                                         2};
  return frame;
}

class Recording : public testing::TestWithParam<std::pair<bool, bool>> {};  // PNG, colour

TEST_P(Recording, IsReadAgainBitForBitWithItsTimeStamps) {
  const auto [png, colour] = GetParam();
  const TemporaryFolder folder;
  {
    Recorder recorder(folder.path(), png ? write_pngs(folder.path()) : write_ffv1(folder.path(), {W, H}, colour, 50),
                      {});
    for (int i = 0; i < 12; ++i) EXPECT_TRUE(recorder.offer(frame_of(i, colour)));
    recorder.finish();
    EXPECT_EQ(recorder.written(), 12u);
    EXPECT_EQ(recorder.stopped(), "");
  }
  ASSERT_TRUE(tracking::is_recording(folder.path()));
  const auto source = tracking::open_source(folder.path(), 0);
  EXPECT_EQ(source->frame_count(), 12u);
  EXPECT_NEAR(source->frame_rate_hz(), 50, 1e-6);
  Frame read;
  for (int i = 0; i < 12; ++i) {
    const Frame written = frame_of(i, colour);
    ASSERT_TRUE(source->next(read)) << i;
    EXPECT_EQ(read.time_s, written.time_s);
    EXPECT_EQ(read.sequence, written.sequence);
    EXPECT_EQ(read.status, written.status);
    EXPECT_EQ(cv::norm(colour ? read.colour : read.grey, colour ? written.colour : written.grey, cv::NORM_INF), 0);
    ASSERT_TRUE(read.capture);
    EXPECT_EQ(read.capture->device_s, written.capture->device_s);
    EXPECT_EQ(read.capture->decoded_s, written.capture->decoded_s);
    EXPECT_EQ(read.capture->clock_is_monotonic, written.capture->clock_is_monotonic);
    EXPECT_EQ(read.capture->device_sequence, written.capture->device_sequence);
    EXPECT_EQ(read.capture->flags, written.capture->flags);
    EXPECT_EQ(read.capture->missing, written.capture->missing);
  }
  EXPECT_FALSE(source->next(read));
}

INSTANTIATE_TEST_SUITE_P(Kinds, Recording,
                         testing::Values(std::pair{false, false}, std::pair{false, true}, std::pair{true, false},
                                         std::pair{true, true}),
                         [](const auto& kind) {
                           return std::string(kind.param.first ? "Png" : "Ffv1") +
                                  (kind.param.second ? "Colour" : "Grey");
                         });

TEST(Recorder, AFullDiskEndsItWithWhatWasWrittenIntact) {
  const TemporaryFolder folder;
  std::atomic<int> asked = 0;
  RecorderOptions options;
  options.free_bytes = [&]() -> std::uint64_t { return ++asked > 7 ? 1000 : std::uint64_t(1) << 40; };
  Recorder recorder(folder.path(), write_ffv1(folder.path(), {W, H}, false, 50), options);
  for (int i = 0; i < 20; ++i) recorder.offer(frame_of(i, false));
  recorder.finish();
  EXPECT_EQ(recorder.written(), 7u);
  EXPECT_NE(recorder.stopped().find("is full"), std::string::npos) << recorder.stopped();
  EXPECT_FALSE(recorder.offer(frame_of(21, false)));
  const auto source = tracking::open_source(folder.path(), 0);
  Frame read;
  for (int i = 0; i < 7; ++i) {
    ASSERT_TRUE(source->next(read));
    EXPECT_EQ(cv::norm(read.grey, frame_of(i, false).grey, cv::NORM_INF), 0);
  }
  EXPECT_FALSE(source->next(read));
}

class SlowWriter final : public PictureWriter {
 public:
  void write(const cv::Mat&) override { std::this_thread::sleep_for(std::chrono::milliseconds(20)); }
  void finish() override {}
};

TEST(Recorder, ASlowDiskDropsFramesAndCountsThem) {
  const TemporaryFolder folder;
  RecorderOptions options;
  options.most_queued_bytes = 4 * W * H;
  Recorder recorder(folder.path(), std::make_unique<SlowWriter>(), options);
  std::uint64_t taken = 0;
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < 30; ++i) taken += recorder.offer(frame_of(i, false));
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(200)) << "offer() does not wait";
  recorder.finish();
  EXPECT_EQ(recorder.written(), taken);
  EXPECT_EQ(recorder.dropped(), 30 - taken);
  EXPECT_LT(taken, 10u);
  EXPECT_LE(recorder.most_queued(), 4u);
}

class BrokenWriter final : public PictureWriter {
 public:
  void write(const cv::Mat&) override {
    if (++count_ == 3) throw ConfigError("disk: is on fire");
  }
  void finish() override {}

 private:
  int count_ = 0;
};

TEST(Recorder, AWriterThatFailsStopsIt) {
  const TemporaryFolder folder;
  Recorder recorder(folder.path(), std::make_unique<BrokenWriter>(), {});
  for (int i = 0; i < 5; ++i) recorder.offer(frame_of(i, false));
  recorder.finish();
  EXPECT_EQ(recorder.written(), 2u);
  EXPECT_EQ(recorder.dropped(), 3u);
  EXPECT_EQ(recorder.stopped(), "disk: is on fire");
}

TEST(Recording, WrongOnesAreRefused) {
  const TemporaryFolder folder;
  EXPECT_FALSE(tracking::is_recording(folder.path()));
  std::filesystem::create_directories(folder / "pictures");
  write_text(folder / "frames.csv", tracking::recorded_header());
  EXPECT_NE(message_of<InputError>([&] { tracking::open_source(folder.path(), 0); }).find("has no frame"),
            std::string::npos);
  Frame a = frame_of(1, false), b = frame_of(0, false);
  write_text(folder / "frames.csv",
             tracking::recorded_header() + tracking::recorded_row(a) + tracking::recorded_row(b));
  EXPECT_NE(message_of<InputError>([&] {
              tracking::open_source(folder.path(), 0);
            }).find("frames.csv:3: time_s does not increase"),
            std::string::npos);
}

}  // namespace
}  // namespace heartservo::test
