#pragma once
// A tracker that says what it is told to, for tests of what is made of it.
#include <utility>
#include <vector>

#include "tools/track_run.hpp"
#include "tracking/frames/frame.hpp"

namespace heartservo::test {

class PuppetTracker final : public tracking::TargetTracker {
 public:
  /// State of each frame, and how far right of (100, 100) the region of 40 x 40 px and every point of it is then.
  using Script = std::vector<std::pair<tracking::TrackState, double>>;
  explicit PuppetTracker(Script script) : says_(std::move(script)) {}

  std::string start(const tracking::Frame&, const tracking::Quad&) override { return ""; }
  tracking::Track track(const tracking::Frame& frame) override {
    const auto [state, right] = says_[frame.sequence];
    if (state != tracking::TrackState::LOST) right_ = right;
    tracking::Track track;
    track.time_s = frame.time_s;
    track.sequence = frame.sequence;
    track.state = state;
    track.quality = state == tracking::TrackState::LOST ? 0 : 0.9 - 0.01 * right;
    track.corners = tracking::rectangle(100 + right, 100, 40, 40);
    track.target = {120 + right, 120};
    return track;
  }
  Eigen::Vector2d carry(const Eigen::Vector2d& start_px) const override {
    return start_px + Eigen::Vector2d(right_, 0);
  }
  void mark_left_out(cv::Mat& mask) override {
    if (mask.empty()) mask = cv::Mat::zeros(240, 320, CV_8UC1);
    mask(cv::Rect(110, 110, 5, 5)).setTo(255);
  }

 private:
  Script says_;
  double right_ = 0;
};

/// The way of such a tracker through all its frames; `truth(k)` of frame k, or nothing.
inline tools::TrackLane puppet_lane(const std::string& name, const PuppetTracker::Script& script,
                                    const tools::TruthKind& kind = {},
                                    const std::function<tools::TrackTruth(std::size_t)>& truth = {}) {
  tools::TrackLane lane(name, std::make_unique<PuppetTracker>(script), nullptr, kind, script.size());
  tracking::Frame frame;
  lane.start(frame, {tracking::rectangle(100, 100, 40, 40), {120, 120}, {115, 125}});
  for (std::size_t k = 0; k < script.size(); ++k) {
    frame.sequence = k;
    frame.time_s = 0.01 * static_cast<double>(k);
    lane.follow(frame, truth ? truth(k) : tools::TrackTruth{}, [] { return 0.0; });
  }
  return lane;
}

}  // namespace heartservo::test
