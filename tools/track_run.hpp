#pragma once
// Trackers side by side on the same frames: what `track` does between opening the source and writing the run folder.
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/time_table.hpp"
#include "tools/track_score.hpp"
#include "tracking/frames/live_source.hpp"
#include "tracking/landmark/target_estimator.hpp"
#include "tracking/planar/target_tracker.hpp"

namespace heartservo::tools {

/// Where tracking begins. px, in the first frame.
struct TrackStart {
  tracking::Quad region;
  Eigen::Vector2d centre;                                  ///< of the region as the camera sees it (region_centre())
  Eigen::Vector2d point = Eigen::Vector2d::Constant(NAN);  ///< the point to score, if there is one
  std::size_t number = 0;                                  ///< of the region, from 1; 0 where there is only one
};

/// One tracker's way through a sequence.
class TrackLane {
 public:
  /// `estimator` may be null: no metric pose. `truth`: what follow() will be given.
  /// `live`: the camera, null for recorded frames; must outlive this.
  TrackLane(std::string name, std::unique_ptr<tracking::TargetTracker> tracker,
            std::unique_ptr<tracking::TargetEstimator> estimator, const TruthKind& truth, std::size_t frames,
            const tracking::LiveSource* live = nullptr);

  const std::string& name() const { return name_; }

  /// "" or the reason for which the tracker refuses the region.
  std::string start(const tracking::Frame& frame, const TrackStart& start);

  /// The region anew, or another one, with a new tracker and estimator (null as in the constructor). "" or the reason
  /// for which it is refused: then all stays as it was.
  std::string restart(std::unique_ptr<tracking::TargetTracker> tracker,
                      std::unique_ptr<tracking::TargetEstimator> estimator, const tracking::Frame& frame,
                      const TrackStart& start);

  /// Follows one frame. The result stays until the next call.
  const tracking::Track& follow(const tracking::Frame& frame, const TrackTruth& truth, double (*now_s)());
  const tracking::Track& track() const { return track_; }
  const TrackScore::Errors& errors() const { return errors_; }
  const TrackStart& began() const { return start_; }
  /// Of the last frame; LOST where no metric pose is known.
  const tracking::TargetState& state() const { return state_; }
  double last_ms() const { return ms_.empty() ? 0 : ms_.back(); }

  /// See TargetTracker: call it before the frame's pixels go away.
  void mark_left_out(cv::Mat& mask) { tracker_->mark_left_out(mask); }

  /// This tracker's entry of summary.json: its name, the score, and
  ///   ms               {p50, p99, max} of one frame
  ///   region           its number, from 1, where there are several
  ///   position_error_mm  {x, y, z}: {rms, mean, std, max}, normalised_z: mean of (error / standard deviation)^2; of a
  ///                      metric lane whose true position is known, over the frames that have a pose
  ///   displacement_px  {x, y} of the region's centre since the first frame: {min, max, peak_to_peak, rms}
  nlohmann::json summary() const;

  /// Its CSV: time_s, frame/sequence, track/state, track/quality, track/corner0..3, target (the centre of the region),
  /// displacement (of the target since the first frame), error_px (of the corners), timing/track_ms; with the truth
  /// that there is: truth/corner0..3; point, truth/point, point/error_px; and when metric: measured (with sigma/z_m), pose,
  /// and truth where known; of a camera: frame/age_s (when tracking began), capture/device_sequence, capture/skipped.
  /// A LOST frame has no place.
  const TimeTable& table() const { return table_; }

 private:
  void measure(const tracking::Frame& frame, const TrackTruth& truth);

  std::string name_;
  std::unique_ptr<tracking::TargetTracker> tracker_;
  std::unique_ptr<tracking::TargetEstimator> estimator_;
  const tracking::LiveSource* live_;
  TruthKind truth_;
  TimeTable table_;
  TrackScore score_;
  TrackStart start_;
  tracking::Track track_;
  tracking::TargetState state_;
  TrackScore::Errors errors_;
  Eigen::Vector2d point_ = Eigen::Vector2d::Constant(NAN);
  std::vector<double> row_, ms_, u_px_, v_px_;
  std::array<std::vector<double>, 3> errors_m_;
  double normalised_ = 0;
};

/// Follows one frame in all lanes, which lie region by region. Regions go to as many cores as there are if `threaded`;
/// trackers that are compared on one region come one after the other, so that they do not take each other's time.
void follow_all(const tracking::Frame& frame, const std::vector<TrackTruth>& truths, bool threaded, double (*now_s)(),
                std::vector<TrackLane>& lanes);

}  // namespace heartservo::tools
