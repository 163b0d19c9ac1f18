#include "sim/table/point_tracks.hpp"

#include <gtest/gtest.h>

#include "tests/support/message.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::sim {
namespace {

using test::message_of;

class PointTracksFile : public testing::Test {
 protected:
  PointTracks read(const std::string& text) const {
    test::write_text(file_, text);
    return PointTracks::read(file_.string());
  }
  template <class Error = InputError>
  std::string refusal(const std::string& text) const {
    const std::string message = message_of<Error>([&] { read(text); });
    return message.substr(std::min(message.size(), file_.string().size()));  // without the file's name
  }
  std::string choice(const PointTracks& tracks, const std::string& name, const tracking::Quad& region) const {
    const std::string message = message_of<ConfigError>([&] { tracks.choose(name, region); });
    return message.substr(std::min(message.size(), file_.string().size()));
  }

  const test::TemporaryFolder folder_;
  const std::filesystem::path file_ = folder_ / "points.csv";
};

constexpr const char* kFrames =
    "frame,point,u_px,v_px,visible\n1,A,10,20,1\n1,B,14,20,1\n2,A,11,22,1\n2,B,15,22,0\n3,B,16,24,1\n1,C,90,90,0\n";

TEST_F(PointTracksFile, FramesCountFromOneAndRowsThatAreNotVisibleDoNotCount) {
  const PointTracks tracks = read(kFrames);
  ASSERT_EQ(tracks.points().size(), 3u);
  const PointTrack &a = tracks.points()[0], &b = tracks.points()[1];
  EXPECT_EQ(a.name, "A");
  EXPECT_EQ(a.at(0, 99), Eigen::Vector2d(10, 20)) << "the time does not matter";
  EXPECT_EQ(a.at(1, 0), Eigen::Vector2d(11, 22));
  EXPECT_FALSE(a.at(2, 0).allFinite()) << "after its last row";
  EXPECT_FALSE(b.at(1, 0).allFinite()) << "not visible, and nothing is put between frames";
  EXPECT_EQ(b.at(2, 0), Eigen::Vector2d(16, 24));
}

TEST_F(PointTracksFile, TimesAreFoundAndBetweenThemTheLineIsStraight) {
  const PointTrack p = read("time_s,u_px,v_px\n0,10,20\n0.04,12,24\n0.08,,\n0.12,14,28\n").points()[0];
  EXPECT_EQ(p.name, "");
  EXPECT_EQ(p.at(7, 0.04 + 1e-9), Eigen::Vector2d(12, 24));
  EXPECT_LT((p.at(0, 0.03) - Eigen::Vector2d(11.5, 23)).norm(), 1e-12);
  for (const double hidden_s : {-0.01, 0.06, 0.08, 0.1, 0.13}) EXPECT_FALSE(p.at(0, hidden_s).allFinite()) << hidden_s;
}

TEST_F(PointTracksFile, OtherColumnsAreIgnoredInAnyOrder) {
  const PointTracks tracks = read("v_px,note,point,frame,u_px,sigma_px\r\n20,x,A,1,10,0.5\r\n22,,A,2,11,\r\n");
  EXPECT_EQ(tracks.points()[0].at(1, 0), Eigen::Vector2d(11, 22));
}

TEST_F(PointTracksFile, GarbledFilesAreRefusedWithTheLine) {
  EXPECT_EQ(refusal("").find(":1: is empty; expected a header with frame or time_s"), 0u);
  for (const char* header : {"\x89PNG\r\n\x1a\n", "u_px,v_px\n1,2\n", "frame,u_px\n1,2\n", "frame,time_s,u_px,v_px\n"})
    EXPECT_EQ(refusal(header).find(":1: expected a header with frame or time_s"), 0u) << header;
  EXPECT_EQ(refusal("frame,u_px,v_px,visable\n1,2,3,0\n"),
            ":1: column 'visable' is not known (did you mean 'visible'?)");
  EXPECT_EQ(refusal("frame,u_px,v_px\n"), ": has a header and no rows");
  const std::string header = "frame,point,u_px,v_px,visible\n";
  EXPECT_EQ(refusal(header + "1,A,2,3\n"), ":2: 4 cells under 5 columns");
  EXPECT_EQ(refusal(header + "1,A,2 mm,3,1\n"), ":2: '2 mm' under u_px is not a number");
  EXPECT_EQ(refusal(header + "0,A,2,3,1\n"), ":2: frame must be a whole number from 1");
  EXPECT_EQ(refusal(header + "1.5,A,2,3,1\n"), ":2: frame must be a whole number from 1");
  EXPECT_EQ(refusal(header + ",A,2,3,1\n"), ":2: frame must be a whole number from 1");
  EXPECT_EQ(refusal(header + "1,,2,3,1\n"), ":2: the point has no name");
  EXPECT_EQ(refusal(header + "1,A,2,3,2\n"), ":2: visible must be 0 or 1");
  EXPECT_EQ(refusal(header + "1,A,2,3,\n"), ":2: visible must be 0 or 1");
  EXPECT_EQ(refusal(header + "1,A,2,,1\n").find(":2: u_px and v_px must both"), 0u);
  EXPECT_EQ(refusal(header + "1,A,inf,3,1\n").find(":2: u_px and v_px must both"), 0u);
  EXPECT_EQ(refusal(header + "2,A,2,3,1\n2,B,2,3,1\n\n2,A,2,3,1\n"),
            ":5: frame 2 after 2; the rows of a point must go on in time");
  EXPECT_EQ(refusal("time_s,u_px,v_px\n0.5,1,1\n0.25,1,1\n"),
            ":3: time 0.25 after 0.5; the rows of a point must go on in time");
  EXPECT_NE(message_of<InputError>([] { PointTracks::read("/nowhere.csv"); }).find("/nowhere.csv: cannot be read"),
            std::string::npos);
}

TEST_F(PointTracksFile, ThePointNearestToTheMiddleOfTheRegionIsChosen) {
  const PointTracks tracks = read(kFrames);
  EXPECT_EQ(tracks.choose("", tracking::rectangle(0, 0, 26, 40)).name, "B") << "centre at (13, 20)";
  EXPECT_EQ(tracks.choose("", tracking::rectangle(0, 0, 13, 40)).name, "A") << "B is outside";
  EXPECT_EQ(tracks.choose("A", tracking::rectangle(0, 0, 26, 40)).name, "A");
  EXPECT_EQ(tracks.choose("", {Eigen::Vector2d(10, 10), {20, 20}, {10, 30}, {0, 20}}).name, "A") << "a turned region";
}

TEST_F(PointTracksFile, PointsThatCannotBeCarriedAreRefused) {
  const PointTracks tracks = read("frame,point,u_px,v_px\n1,vein,10,20\n1,spot,50,20\n2,late,10,20\n");
  const auto region = tracking::rectangle(0, 0, 20, 40);
  EXPECT_EQ(choice(tracks, "vien", region), ": no point 'vien' (did you mean 'vein'?); it has vein, spot, late");
  EXPECT_EQ(choice(tracks, "late", region), ": point 'late' is not visible in the first frame");
  EXPECT_EQ(choice(tracks, "spot", region).find(": point 'spot' lies at (50.0, 20.0) in the first frame, outside"), 0u);
  EXPECT_EQ(choice(tracks, "", tracking::rectangle(100, 100, 20, 20)).find(": no point is inside the region"), 0u);
  const PointTracks unnamed = read("time_s,u_px,v_px\n1,10,20\n");
  EXPECT_EQ(choice(unnamed, "vein", region), ": its point has no name; leave 'vein' out");
  EXPECT_EQ(unnamed.choose("", region).at(0, 1), Eigen::Vector2d(10, 20)) << "may begin later";
}

}  // namespace
}  // namespace heartservo::sim
