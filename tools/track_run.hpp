#pragma once
// Trackers side by side on the same frames: what `track` does between opening the source and writing the run folder.
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/time_table.hpp"
#include "tracking/landmark/target_estimator.hpp"
#include "tracking/planar/target_tracker.hpp"

namespace heartservo::tools {

/// One tracker's way through a sequence.
class TrackLane {
 public:
  /// `estimator` may be null: no metric pose.
  TrackLane(std::string name, std::unique_ptr<tracking::TargetTracker> tracker,
            std::unique_ptr<tracking::TargetEstimator> estimator, std::size_t frames);

  const std::string& name() const { return name_; }

  /// "" or the reason for which the tracker refuses the region.
  std::string start(const tracking::Frame& frame, const tracking::Quad& region);

  /// Follows one frame; `truth` is where the corners truly are, or null. The result stays until the next call.
  const tracking::Track& follow(const tracking::Frame& frame, const tracking::Quad* truth, double (*now_s)());

  /// This tracker's entry of summary.json. `wrong_ok_frames` were called OK though the true corners are over 5 px off;
  /// `score_lost_frames` are those LOST and all over 5 px off; both null without truth.
  nlohmann::json summary() const;

  const TimeTable& table() const { return table_; }

 private:
  std::string name_;
  std::unique_ptr<tracking::TargetTracker> tracker_;
  std::unique_ptr<tracking::TargetEstimator> estimator_;
  TimeTable table_;
  tracking::Track track_;
  std::size_t lost_ = 0, uncertain_ = 0, relocks_ = 0;
  std::size_t wrong_ok_ = 0, score_lost_ = 0;  // against truth: over 5 px off and called OK; LOST or over 5 px off
  bool scored_ = false;
  std::vector<double> errors_px_, ms_, u_px_, v_px_;
  Eigen::Vector2d start_px_ = Eigen::Vector2d::Zero();
};

/// The side-by-side table for the terminal.
std::string track_table(const nlohmann::json& summary);

}  // namespace heartservo::tools
