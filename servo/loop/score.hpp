#pragma once
// The residual, scored on truth from outside the loop: nothing here is included by a stage. Every frame after the
// settling time counts, lost ones too.
#include <Eigen/Core>
#include <optional>
#include <vector>

#include "tracking/planar/quad.hpp"

namespace heartservo::servo {

struct LoopRecord;

/// What truly was at a frame's time. Positions in m, camera frame. Without 3D truth (a recorded sequence) only the
/// pixel positions are known, and those of the goal may be missing in a frame (NaN).
struct TruthSample {
  std::optional<Eigen::Vector3d> target, goal, tip;
  Eigen::Vector2d goal_px = Eigen::Vector2d::Constant(NAN), tip_px = Eigen::Vector2d::Constant(NAN);
  std::optional<tracking::Quad> corners_px;  ///< of the tracked region
  std::optional<double> force_n;             ///< contact force
};

struct Spread {
  double mean = 0, std = 0, rms = 0, p95 = 0, max = 0;
  std::size_t count = 0;
};

/// Mean, standard deviation, root mean square, 95th percentile and maximum of |v|; NaN entries are not counted.
Spread spread_of(std::vector<double> values);

/// The p-th percentile (0..100, linear between ranks); 0 for none.
double percentile(std::vector<double> values, double p);

struct ScoreSummary {
  std::size_t frames = 0, scored_frames = 0;
  bool metric = false;                                            ///< 3D truth was there
  double motion_rms = 0, reduction_percent = 0;                   ///< m; of the goal around its mean
  Eigen::Vector3d motion_peak_to_peak = Eigen::Vector3d::Zero();  ///< m
  Spread residual;                                                ///< m
  Eigen::Vector3d residual_axis_rms = Eigen::Vector3d::Zero();    ///< m
  Spread residual_px, corner_error_px, motion_px;
  double reduction_percent_px = 0;
  std::size_t lost_frames = 0, uncertain_frames = 0, relocks = 0, unreadable_frames = 0, limited_commands = 0;
  Eigen::Vector3d position_error_std = Eigen::Vector3d::Zero(), position_error_max = Eigen::Vector3d::Zero();  ///< m
  Spread force_error;        ///< N, while pressing (0.5 s after its begin and later)
  double force_peak_n = 0;   ///< of the whole run
  std::size_t touches = 0;   ///< times that contact began
  double max_speed = 0, max_step_m = 0;  ///< m/s; m per period, of the commands
  double track_ms_p50 = 0, track_ms_p99 = 0, track_ms_max = 0;
  double chain_ms_p50 = 0, chain_ms_p99 = 0, chain_ms_max = 0;
};

class Score {
 public:
  Score(double settle_s, double period_s) : settle_s_(settle_s), period_s_(period_s) {}

  void reserve(std::size_t frames);
  void add(const LoopRecord& record, const TruthSample& truth);
  ScoreSummary summary() const;

 private:
  double settle_s_, period_s_;
  std::optional<double> first_time_s_;
  ScoreSummary counts_;
  std::vector<Eigen::Vector3d> goals_, residuals_, position_errors_;
  std::vector<Eigen::Vector2d> goals_px_;
  std::vector<double> force_errors_;
  double pressing_s_ = 0, last_force_n_ = 0;
  std::vector<double> residuals_px_, corner_errors_px_, track_ms_, chain_ms_;
};

}  // namespace heartservo::servo
