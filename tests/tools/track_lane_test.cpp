#include <gtest/gtest.h>

#include "tools/track_run.hpp"
#include "tracking/frames/frame.hpp"

namespace heartservo::tools {
namespace {

using tracking::TrackState;

// Says what it is told to.
class Puppet final : public tracking::TargetTracker {
 public:
  std::vector<std::pair<TrackState, double>> says;  // state, and how far right of (100, 100) the region is
  std::string start(const tracking::Frame&, const tracking::Quad&) override { return ""; }
  tracking::Track track(const tracking::Frame& frame) override {
    tracking::Track track;
    track.state = says[frame.sequence].first;
    track.corners = tracking::rectangle(100 + says[frame.sequence].second, 100, 40, 40);
    return track;
  }
  Eigen::Vector2d carry(const Eigen::Vector2d& start_px) const override { return start_px; }
  void mark_left_out(cv::Mat&) override {}
};

nlohmann::json summary_of(std::vector<std::pair<TrackState, double>> says, bool with_truth) {
  auto puppet = std::make_unique<Puppet>();
  puppet->says = std::move(says);
  const std::size_t frames = puppet->says.size();
  TrackLane lane("puppet", std::move(puppet), nullptr, frames);
  const tracking::Quad truth = tracking::rectangle(100, 100, 40, 40);
  tracking::Frame frame;
  lane.start(frame, truth);
  for (std::size_t k = 0; k < frames; ++k) {
    frame.sequence = k;
    frame.time_s = 0.01 * static_cast<double>(k);
    lane.follow(frame, with_truth ? &truth : nullptr, [] { return 0.0; });
  }
  return lane.summary();
}

TEST(TrackLane, CountsWhatIsCalledOkAndIsNot) {
  const auto summary = summary_of({{TrackState::OK, 0},
                                   {TrackState::OK, 4.9},
                                   {TrackState::OK, 5.1},
                                   {TrackState::OK, 80},
                                   {TrackState::UNCERTAIN, 6},
                                   {TrackState::LOST, 0}},
                                  true);
  EXPECT_EQ(summary["lost_frames"], 1);
  EXPECT_EQ(summary["wrong_ok_frames"], 2);
  EXPECT_EQ(summary["score_lost_frames"], 4);
  EXPECT_NEAR(summary["error_px"]["max"].get<double>(), 80, 1e-9);
  EXPECT_NE(track_table({{"source", "s"}, {"frames", 6}, {"trackers", {summary}}}).find("wrong OK"), std::string::npos);
}

TEST(TrackLane, WithoutTruthNothingIsSaidToBeWrong) {
  const auto summary = summary_of({{TrackState::OK, 80}, {TrackState::LOST, 0}}, false);
  EXPECT_TRUE(summary["wrong_ok_frames"].is_null());
  EXPECT_TRUE(summary["score_lost_frames"].is_null());
  EXPECT_TRUE(summary["error_px"].is_null());
  EXPECT_EQ(summary["lost_frames"], 1);
}

}  // namespace
}  // namespace heartservo::tools
