// What is made of a tracker's results: the score, the CSV, the table for plots.
#include <gtest/gtest.h>

#include "tests/tools/puppet_tracker.hpp"
#include "tools/corner_truth.hpp"
#include "tools/track_report.hpp"

namespace heartservo::tools {
namespace {

using test::puppet_lane;
using tracking::TrackState;

constexpr auto OK = TrackState::OK, UNCERTAIN = TrackState::UNCERTAIN, LOST = TrackState::LOST;
const tracking::Quad kStill = tracking::rectangle(100, 100, 40, 40);

TrackTruth still_corners(std::size_t) { return {kStill, Eigen::Vector2d::Constant(NAN)}; }
TrackTruth still_point(std::size_t) { return {std::nullopt, {115, 125}}; }

TEST(TrackLane, CountsWhatIsCalledOkAndIsNot) {
  const auto summary =
      puppet_lane("p", {{OK, 0}, {OK, 4.9}, {OK, 5.1}, {OK, 80}, {UNCERTAIN, 6}, {LOST, 0}}, {true, {}}, still_corners)
          .summary();
  EXPECT_EQ(summary["name"], "p");
  EXPECT_EQ(summary["lost_frames"], 1);
  EXPECT_EQ(summary["uncertain_frames"], 1);
  EXPECT_EQ(summary["wrong_ok_frames"], 2);
  EXPECT_EQ(summary["score_lost_frames"], 4);
  EXPECT_EQ(summary["wrong_over_px"], (nlohmann::json{{"corners", 5}}));
  EXPECT_NEAR(summary["error_px"]["max"].get<double>(), 80, 1e-9);
  EXPECT_NEAR(summary["error_px"]["mean"].get<double>(), (4.9 + 5.1 + 80 + 6) / 5, 1e-9);
  EXPECT_TRUE(summary["point_error_px"].is_null());
  EXPECT_EQ(summary["first_failure"], (nlohmann::json{{"sequence", 2}, {"time_s", 0.02}, {"reason", "off"}}));
}

TEST(TrackLane, WithoutTruthNothingIsSaidToBeWrong) {
  const auto summary = puppet_lane("p", {{OK, 80}, {LOST, 0}}).summary();
  for (const char* key : {"wrong_ok_frames", "score_lost_frames", "wrong_over_px", "error_px", "point_error_px"})
    EXPECT_TRUE(summary[key].is_null()) << key;
  EXPECT_EQ(summary["lost_frames"], 1);
  EXPECT_EQ(summary["first_failure"]["reason"], "lost");
  EXPECT_EQ(summary["first_failure"]["sequence"], 1);
}

TEST(TrackLane, ScoresAPointWhereItIsVisible) {
  const auto truth = [](std::size_t k) { return k == 2 ? TrackTruth{} : still_point(k); };
  const auto summary =
      puppet_lane("p", {{OK, 0}, {OK, 1}, {OK, 50}, {UNCERTAIN, 3}, {OK, 8.1}, {LOST, 0}, {OK, 2}}, {false, "C"}, truth)
          .summary();
  const auto& e = summary["point_error_px"];
  EXPECT_EQ(e["name"], "C");
  EXPECT_EQ(e["frames"], 5) << "neither the frame without annotation nor the LOST one";
  EXPECT_EQ(e["visible_frames"], 6);
  EXPECT_NEAR(e["median"].get<double>(), 2, 1e-9) << "of 0 1 3 8.1 2";
  EXPECT_NEAR(e["mean"].get<double>(), 14.1 / 5, 1e-9);
  EXPECT_NEAR(e["max"].get<double>(), 8.1, 1e-9);
  EXPECT_NEAR(e["p95"].get<double>(), 3 + 0.8 * 5.1, 1e-9);
  EXPECT_NEAR(e["std"].get<double>(), std::sqrt(7.9696), 1e-9);
  EXPECT_NEAR(e["with_lost"]["median"].get<double>(), 2.5, 1e-9) << "the LOST frame counts as 8.1, last believed";
  EXPECT_NEAR(e["with_lost"]["p95"].get<double>(), 8.1, 1e-9);
  EXPECT_EQ(summary["wrong_ok_frames"], 1) << "8.1 px; the 50 px cannot be known to be wrong";
  EXPECT_EQ(summary["wrong_over_px"], (nlohmann::json{{"point", 8}}));
  EXPECT_EQ(summary["score_lost_frames"], 2);
  EXPECT_TRUE(summary["error_px"].is_null());
}

TEST(TrackLane, APointNeverFollowedHasNoErrorButOneWithLost) {
  const auto e = puppet_lane("p", {{LOST, 0}, {LOST, 0}}, {false, "C"}, still_point).summary()["point_error_px"];
  EXPECT_EQ(e["frames"], 0);
  EXPECT_EQ(e["visible_frames"], 2);
  for (const char* key : {"median", "p95", "mean", "std", "max"}) EXPECT_TRUE(e[key].is_null()) << key;
  EXPECT_EQ(e["with_lost"]["max"], 0);
}

TEST(TrackLane, ANanOfATrackerIsWrong) {
  const auto summary = puppet_lane("p", {{OK, NAN}}, {true, "C"}, [](std::size_t) {
                         return TrackTruth{kStill, {115, 125}};
                       }).summary();
  EXPECT_EQ(summary["wrong_ok_frames"], 1);
}

TEST(TrackLane, TheTableHasWhatIsKnown) {
  const TrackLane bare = puppet_lane("p", {{OK, 0}, {OK, 3}, {LOST, 0}});
  EXPECT_EQ(bare.table().columns(),
            (std::vector<std::string>{"time_s", "frame/sequence", "track/state", "track/quality", "track/corner0/u_px",
                                      "track/corner0/v_px", "track/corner1/u_px", "track/corner1/v_px",
                                      "track/corner2/u_px", "track/corner2/v_px", "track/corner3/u_px",
                                      "track/corner3/v_px", "target/u_px", "target/v_px", "displacement/u_px",
                                      "displacement/v_px", "error_px", "timing/track_ms"}));
  EXPECT_EQ(bare.table().column("target/u_px")[1], 123);
  EXPECT_EQ(bare.table().column("displacement/u_px")[1], 3);
  EXPECT_TRUE(std::isnan(bare.table().column("target/u_px")[2])) << "a LOST frame has no place";
  const TrackLane all = puppet_lane("p", {{OK, 3}}, {true, "C"}, [](std::size_t) {
    return TrackTruth{kStill, {115, 125}};
  });
  EXPECT_EQ(all.table().column("truth/corner2/v_px")[0], 140);
  EXPECT_EQ(all.table().column("truth/point/u_px")[0], 115);
  EXPECT_EQ(all.table().column("point/u_px")[0], 118);
  EXPECT_EQ(all.table().column("point/error_px")[0], 3);
  EXPECT_EQ(all.table().column("error_px")[0], 3);
}

TEST(SideBySide, HasEveryTrackerAndTheTruth) {
  std::vector<TrackLane> lanes;
  lanes.push_back(puppet_lane("a", {{OK, 0}, {OK, 2}, {LOST, 0}}, {false, "C"}, still_point));
  lanes.push_back(puppet_lane("b", {{OK, 0}, {OK, 1}, {OK, 1}}, {false, "C"}, still_point));
  const TimeTable table = side_by_side(lanes);
  EXPECT_EQ(table.rows(), 3u);
  EXPECT_EQ(table.column("truth/u_px")[1], 0) << "displacement of the annotated point";
  EXPECT_EQ(table.column("a/u_px")[1], 2);
  EXPECT_EQ(table.column("b/u_px")[2], 1);
  EXPECT_TRUE(std::isnan(table.column("a/u_px")[2])) << "a gap where LOST";
  EXPECT_EQ(table.column("a/error_px")[1], 2);
  EXPECT_EQ(table.column("a/state")[2], 2);
  std::vector<TrackLane> bare;
  bare.push_back(puppet_lane("a", {{OK, 0}, {OK, 2}}));
  const TimeTable plain = side_by_side(bare);
  EXPECT_EQ(plain.column("a/u_px")[1], 2);
  EXPECT_FALSE(plain.has("truth/u_px"));
  EXPECT_FALSE(plain.has("a/error_px"));
}

TEST(TrackReport, PutsAllTrackersInOnePlotAndAStripForEach) {
  std::vector<TrackLane> lanes;
  lanes.push_back(puppet_lane("a", {{OK, 0}, {OK, 9}, {LOST, 0}}, {false, "C"}, still_point));
  lanes.push_back(puppet_lane("b", {{OK, 0}, {OK, 1}, {OK, 1}}, {false, "C"}, still_point));
  nlohmann::json summary{{"source", "s"}, {"frames", 3}, {"interrupted", false}, {"point", "C"}};
  for (const auto& lane : lanes) summary["trackers"].push_back(lane.summary());
  const TimeTable table = side_by_side(lanes);
  const Report report = track_report(summary, table, {}, {}, "");
  ASSERT_EQ(report.plots.size(), 5u);
  EXPECT_EQ(report.plots[0].title, "Vertical displacement");
  ASSERT_EQ(report.plots[0].series.size(), 3u);
  EXPECT_TRUE(report.plots[0].series[0].is_truth);
  EXPECT_EQ(report.plots[1].title, "Error");
  EXPECT_EQ(report.plots[1].series.size(), 2u);
  EXPECT_EQ(report.plots[2].title, "Horizontal displacement");
  ASSERT_EQ(report.states.size(), 2u);
  EXPECT_EQ(report.states[1].column, "b/state");
  EXPECT_EQ(report.headline.find("b followed the region in 3 of 3 frames, best of 2 trackers."), 0u) << report.headline;
  EXPECT_EQ(report.headline_number, "1.00");
  ASSERT_EQ(report.notices.size(), 1u);
  EXPECT_EQ(report.notices[0], "a called 1 frame OK in which it was wrong.");
  EXPECT_FALSE(report_html(report).empty()) << "every column is there";
}

TEST(RegionCentre, IsWhereTheDiagonalsCrossBehindTheLens) {
  const tracking::Quad tilted{Eigen::Vector2d(0, 0), {40, 10}, {40, 30}, {0, 40}};
  const Eigen::Vector2d flat = region_centre(tilted, {});
  EXPECT_NEAR(flat.y(), 20, 1e-9);
  EXPECT_NEAR(flat.x(), 80.0 / 3, 1e-9) << "the mean of the corners would be 20";
  tracking::Camera lens = tracking::Camera::pinhole(512, 512, 0.9);
  lens.k1 = -0.24;
  // a square in space, seen from the side
  const auto at = [&](double x, double y) { return lens.project({0.01 + x, 0.01 + y, 0.05 + 0.5 * x}); };
  const tracking::Quad seen{at(-0.003, -0.003), at(0.003, -0.003), at(0.003, 0.003), at(-0.003, 0.003)};
  EXPECT_LT((region_centre(seen, lens) - at(0, 0)).norm(), 1e-6);
}

}  // namespace
}  // namespace heartservo::tools
