// What is drawn over frames, and which frames are kept.
#include "tools/track_pictures.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/tools/puppet_tracker.hpp"
#include "tools/overlay.hpp"

namespace heartservo::tools {
namespace {

using test::puppet_lane;
using tracking::TrackState;

constexpr auto OK = TrackState::OK, LOST = TrackState::LOST;

cv::Vec3b at(const ReportPicture& picture, int u, int v) { return picture.bgr.at<cv::Vec3b>(v, u); }
cv::Vec3b bytes(const cv::Scalar& colour) {
  return {static_cast<std::uint8_t>(colour[0]), static_cast<std::uint8_t>(colour[1]),
          static_cast<std::uint8_t>(colour[2])};
}

tracking::Frame grey_frame(std::size_t sequence = 0) {
  tracking::Frame frame;
  frame.grey = cv::Mat(240, 320, CV_8UC1, cv::Scalar(100));
  frame.sequence = sequence;
  frame.time_s = 0.01 * static_cast<double>(sequence);
  return frame;
}

Album::Moment moment(std::size_t index, double badness, bool lost = false) {
  Album::Moment m;
  m.index = index;
  m.time_s = static_cast<double>(index);
  m.badness = badness;
  m.lost = lost;
  return m;
}

// The captions of an album that saw these moments, and the frame that each picture shows.
std::vector<std::string> captions(std::size_t expected, const std::vector<Album::Moment>& moments) {
  Album album(expected, [](double px) { return std::to_string(static_cast<int>(px)) + " px off"; });
  for (const auto& m : moments)
    album.look_at(m, [&] {
      return ReportPicture{"", cv::Mat(1, 1, CV_8UC1, cv::Scalar(static_cast<double>(m.index)))};
    });
  std::vector<std::string> result;
  for (const auto& picture : album.pictures())
    result.push_back(picture.caption + " [" + std::to_string(picture.bgr.at<std::uint8_t>(0, 0)) + "]");
  return result;
}

TEST(Album, KeepsStartMiddleWorstAndFirstLost) {
  EXPECT_EQ(captions(8, {moment(0, 1), moment(1, 2), moment(2, NAN, true), moment(3, NAN, true), moment(4, 3),
                         moment(5, 9), moment(6, 4), moment(7, 9)}),
            (std::vector<std::string>{"0.00 s: start [0]", "4.00 s: middle [4]", "5.00 s: worst moment, 9 px off [5]",
                                      "2.00 s: lost for the first time [2]"}));
}

TEST(Album, AFrameComesOnceAndWhatIsNotThereIsNotSaid) {
  EXPECT_EQ(captions(4, {moment(0, 1), moment(2, 7), moment(3, 2)}),
            (std::vector<std::string>{"0.00 s: start [0]", "2.00 s: middle, worst moment, 7 px off [2]"}));
  EXPECT_EQ(captions(0, {moment(0, NAN), moment(1, NAN)}), (std::vector<std::string>{"0.00 s: start [0]"}));
  EXPECT_TRUE(captions(5, {}).empty());
}

TEST(Album, DrawsOnlyWhatIsKept) {
  Album album(0, [](double) { return ""; });
  int drawn = 0;
  for (std::size_t i = 0; i < 100; ++i)
    album.look_at(moment(i, i == 50 ? 2 : 1), [&] { return ++drawn, ReportPicture{"", cv::Mat(1, 1, CV_8UC1)}; });
  EXPECT_EQ(drawn, 2);
}

TEST(Overlay, TintsWhatIsLeftOutAndNothingElse) {
  cv::Mat picture(20, 20, CV_8UC3, cv::Scalar(10, 20, 200)), mask = cv::Mat::zeros(20, 20, CV_8UC1);
  EXPECT_FALSE(tint_left_out(picture, mask));
  EXPECT_FALSE(tint_left_out(picture, cv::Mat()));
  mask.at<std::uint8_t>(5, 7) = 255;
  const cv::Vec3b before = picture.at<cv::Vec3b>(5, 7), key = bytes(left_out_key().bgr);
  EXPECT_TRUE(tint_left_out(picture, mask));
  const cv::Vec3b after = picture.at<cv::Vec3b>(5, 7);
  for (int c = 0; c < 3; ++c) {
    EXPECT_GT(after[c], std::min(before[c], key[c])) << "translucent: between the pixel and the key's colour";
    EXPECT_LT(after[c], std::max(before[c], key[c]));
  }
  picture.at<cv::Vec3b>(5, 7) = before;
  EXPECT_EQ(cv::norm(picture, cv::Mat(20, 20, CV_8UC3, cv::Scalar(10, 20, 200)), cv::NORM_INF), 0);
}

TEST(TrackAlbum, ShowsRegionMaskAndPointWithTheirKeys) {
  const tracking::Frame frame = grey_frame();
  std::vector<TrackLane> lanes;
  lanes.push_back(puppet_lane("a", {{OK, 0}}, {false, "C"}, [](std::size_t) {
    return TrackTruth{std::nullopt, {150, 60}};
  }));
  TrackAlbum album(1, {false, "C"}, frame);
  album.look_at(frame, lanes, {std::nullopt, {150, 60}});
  const auto pictures = album.pictures(lanes);
  ASSERT_EQ(pictures.size(), 2u) << "the frame and the trajectories";
  const ReportPicture& p = pictures[0];
  EXPECT_EQ(p.caption, "0.00 s: start, middle, worst moment, 73.82 px off");
  EXPECT_EQ(at(p, 120, 100), bytes(region_key(lanes[0].track()).bgr)) << "the region's upper side";
  EXPECT_NE(at(p, 112, 112), cv::Vec3b(100, 100, 100)) << "left out";
  EXPECT_EQ(at(p, 125, 125), cv::Vec3b(100, 100, 100)) << "not left out";
  EXPECT_EQ(at(p, 150, 60), cv::Vec3b(255, 255, 255)) << "the annotated point";
  std::string keys;
  for (const auto& key : p.keys) keys += key.label + "; ";
  EXPECT_EQ(keys, "region, followed; annotated point C; left out: glare, tool, strange pixels; ");
}

TEST(TrackAlbum, NamesTheWorstAndTheLoserOfSeveral) {
  const auto script = [](TrackState state, double right) {
    return test::PuppetTracker::Script{{OK, 0}, {state, right}, {OK, 0}};
  };
  std::vector<TrackLane> lanes;
  for (int i = 0; i < 9; ++i) {
    auto tracker = std::make_unique<test::PuppetTracker>(i == 3   ? script(LOST, 0)
                                                         : i == 8 ? script(OK, 30)
                                                                  : script(OK, i));
    lanes.emplace_back(fmt::format("t{}", i), std::move(tracker), nullptr, TruthKind{}, 3);
    lanes.back().start({}, {tracking::rectangle(100, 100, 40, 40), {120, 120}});
  }
  TrackAlbum album(3, {}, grey_frame());
  for (std::size_t k = 0; k < 3; ++k) {
    const tracking::Frame frame = grey_frame(k);
    for (auto& lane : lanes) lane.follow(frame, {}, [] { return 0.0; });
    album.look_at(frame, lanes, {});
  }
  const auto pictures = album.pictures(lanes);
  ASSERT_EQ(pictures.size(), 3u);
  EXPECT_EQ(pictures[2].caption, "0.01 s: middle, worst moment, t8 quality 0.60, t3 lost for the first time");
  ASSERT_EQ(pictures[2].keys.size(), 10u) << "nine trackers and what the first leaves out";
  EXPECT_EQ(pictures[2].keys[3].label, "t3: LOST");
  EXPECT_EQ(pictures[2].keys[3].mark, PictureKey::Mark::DASHES);
  EXPECT_EQ(pictures[2].keys[8].label, "t8 (thin)") << "its colour is that of t1";
  EXPECT_EQ(pictures[2].keys[9].label, "t0 left out: glare, tool, strange pixels");
}

TEST(TrackAlbum, DrawsTheTrajectoriesOverTheTruth) {
  const auto truth = [](std::size_t k) { return TrackTruth{std::nullopt, {115 + 20.0 * static_cast<double>(k), 125}}; };
  std::vector<TrackLane> lanes;
  lanes.push_back(puppet_lane("a", {{OK, 0}, {OK, 20}, {LOST, 0}}, {false, "C"}, truth));
  const auto picture = TrackAlbum(0, {false, "C"}, grey_frame()).pictures(lanes).front();
  // from (115, 125) to (155, 125) with a margin of 24 px: the part from (91, 101), 10 times as large or less
  const int scale = picture.bgr.cols / 88;
  ASSERT_GE(scale, 2);
  ASSERT_EQ(picture.bgr.cols, 88 * scale);
  const auto place = [&](double u, double v) {
    return at(picture, static_cast<int>((u - 91 + 0.5) * scale), static_cast<int>((v - 101 + 0.5) * scale));
  };
  EXPECT_EQ(place(125, 125), bytes(series_colour(0)));
  EXPECT_EQ(place(145, 125), cv::Vec3b(255, 255, 255)) << "truth alone, where the tracker was LOST";
  EXPECT_EQ(place(125, 140), cv::Vec3b(150, 150, 150)) << "the first frame, pale";
  ASSERT_EQ(picture.keys.size(), 2u);
  EXPECT_EQ(picture.keys[0].label, "truth");
  EXPECT_EQ(picture.keys[1].label, "a");
}

}  // namespace
}  // namespace heartservo::tools
