#include "tracking/frames/stereo_pair.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "tests/support/message.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tracking/frames/frame.hpp"
#include "tracking/frames/image_folder.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tracking {
namespace {

class StereoPairs : public testing::Test {
 protected:
  std::string view(const std::string& name, int count, int grey, cv::Size size = {32, 24}) const {
    std::filesystem::create_directories(folder_ / name);
    for (int i = 0; i < count; ++i)
      cv::imwrite(folder_ / (name + "/" + std::to_string(i) + ".png"), cv::Mat(size, CV_8UC1, cv::Scalar(grey + i)));
    return folder_ / name;
  }
  static std::unique_ptr<FrameSource> pair(const std::string& left, const std::string& right) {
    return pair_views(open_image_folder(left, 25), open_image_folder(right, 25));
  }

  test::TemporaryFolder folder_;
};

TEST_F(StereoPairs, ComeFrameByFrame) {
  const auto source = pair(view("left", 3, 50), view("right", 3, 100));
  Frame frame;
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(source->next(frame));
    EXPECT_EQ(frame.grey.at<std::uint8_t>(0, 0), 50 + i);
    EXPECT_EQ(frame.right.at<std::uint8_t>(0, 0), 100 + i);
  }
  EXPECT_FALSE(source->next(frame));
}

TEST_F(StereoPairs, ThatAreNoneAreNamed) {
  const auto left = view("left", 5, 50);
  const auto message = [&](const std::string& right) {
    return test::message_of<InputError>([&] { pair(left, right); });
  };
  const std::string fewer = message(view("fewer", 4, 50));
  for (const char* part : {"fewer", "4 frames", "5", "pairs"}) EXPECT_NE(fewer.find(part), std::string::npos) << fewer;
  EXPECT_NE(message(view("large", 5, 50, {64, 48})).find("64 x 48"), std::string::npos);
}

TEST_F(StereoPairs, ABrokenRightPictureIsNoted) {
  const auto left = view("left", 2, 50), right = view("right", 2, 100);
  std::filesystem::resize_file(right + "/1.png", 40);
  const auto source = pair(left, right);
  Frame frame;
  ASSERT_TRUE(source->next(frame) && source->next(frame));
  EXPECT_EQ(frame.status, FrameStatus::OK);
  EXPECT_TRUE(frame.right.empty());
  EXPECT_NE(frame.note.find("right view"), std::string::npos);
}

}  // namespace
}  // namespace heartservo::tracking
