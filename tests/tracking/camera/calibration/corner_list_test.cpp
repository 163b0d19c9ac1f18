#include "tracking/camera/calibration/corner_list.hpp"

#include <gtest/gtest.h>

#include "tests/support/files.hpp"
#include "tests/support/message.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tracking {
namespace {

class CornerList : public testing::Test {
 protected:
  // 4 x 3 corners, 20 px apart.
  static std::string text(const std::string& separator = " ") {
    std::string result;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 4; ++c)
        result += std::to_string(100 + 20 * c) + ".5" + separator + std::to_string(50 + 20 * r) + "\n";
    return result;
  }
  Corners read(const std::string& content) const {
    return read_corner_list(folder_.write("list.txt", content), board_, 320, 240);
  }
  std::string refusal(const std::string& content) const {
    const std::string message = test::message_of<InputError>([&] { read(content); });
    const std::string file = folder_ / "list.txt";
    EXPECT_EQ(message.rfind(file, 0), 0u) << message;
    return message.substr(std::min(file.size(), message.size()));
  }

  test::TemporaryFolder folder_;
  Board board_{BoardKind::CHESSBOARD, 4, 3, 0.003, 0};
};

TEST_F(CornerList, IsReadWithAnyUsualSeparator) {
  for (const char* separator : {" ", ",", ";", "\t", " , "}) {
    const auto corners = read(text(separator));
    ASSERT_EQ(corners.size(), 12u);
    EXPECT_EQ(corners[5], Eigen::Vector2d(120.5, 70));
  }
  EXPECT_EQ(read("# found by hand\n\nu, v\r\n" + text() + "\n").size(), 12u);
}

TEST_F(CornerList, NamesTheBadLine) {
  EXPECT_NE(refusal(text() + "1 2 3\n").find(":13: expected 'u v' in px, found 3 words"), std::string::npos);
  EXPECT_NE(refusal(text() + "1 2px\n").find(":13: '2px' is not a number"), std::string::npos);
  EXPECT_NE(refusal("nan 3\n" + text().substr(9)).find("nan"), std::string::npos);
  EXPECT_NE(refusal("100.5 inf\n").find("inf"), std::string::npos);
  EXPECT_NE(refusal("100.5 50\n120.5 1e999\n").find(":2: holds inf"), std::string::npos);
  EXPECT_NE(refusal("100.5 250\n").find(":1: corner (100.5, 250) is outside the picture of 320 x 240 px"),
            std::string::npos);
  EXPECT_NE(refusal("").find("has 0 corners, a board of 4 x 3 has 12"), std::string::npos);
  EXPECT_NE(refusal(text() + "1 2\n").find("has 13 corners"), std::string::npos);
  EXPECT_NE(refusal(std::string("\x89PNG\0\n", 6)).find("not a text file"), std::string::npos);
}

TEST_F(CornerList, NamesWhatIsNoBoard) {
  std::swap(board_.columns, board_.rows);
  EXPECT_NE(refusal(text()).find("--columns 4 --rows 3"), std::string::npos);
  std::swap(board_.columns, board_.rows);
  std::string mirrored;
  for (int r = 0; r < 3; ++r)
    for (int c = 3; c >= 0; --c) mirrored += std::to_string(100 + 20 * c) + " " + std::to_string(50 + 20 * r) + "\n";
  EXPECT_NE(refusal(mirrored).find("mirrored"), std::string::npos);
}

TEST_F(CornerList, ThatIsNotThereIsSaid) {
  const auto message = [&](const std::string& file) {
    return test::message_of<InputError>([&] { read_corner_list(file, board_, 320, 240); });
  };
  EXPECT_NE(message(folder_ / "absent.txt").find("no such file"), std::string::npos);
  EXPECT_NE(message(folder_.path()).find("not a file"), std::string::npos);
}

}  // namespace
}  // namespace heartservo::tracking
