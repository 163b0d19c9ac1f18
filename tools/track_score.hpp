#pragma once
// One tracker against what is known of the sequence: corners of the region, a point of it, or nothing.
#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tracking/planar/track.hpp"

namespace heartservo::tools {

/// What is known of a frame beside its pixels.
struct TrackTruth {
  std::optional<tracking::Quad> corners;                   ///< px
  Eigen::Vector2d point = Eigen::Vector2d::Constant(NAN);     ///< px; NaN where it is not visible
  Eigen::Vector3d position = Eigen::Vector3d::Constant(NAN);  ///< m, camera frame, of the region's centre
};

/// What a sequence's truth holds.
struct TruthKind {
  bool corners = false;
  std::optional<std::string> point;  ///< its name; "" where it has none
  bool metric = false;               ///< the position is known
};

/// A region further off than this, mean of the corners, is another region.
constexpr double kWrongCorners_px = 5;
/// The same of a single point, found by hand on tissue that deforms.
constexpr double kWrongPoint_px = 8;

class TrackScore {
 public:
  explicit TrackScore(TruthKind kind) : kind_(std::move(kind)) {}

  /// NaN where unknown, or where the track is LOST.
  struct Errors {
    double corners_px = NAN, point_px = NAN;
  };
  /// `point`: where the tracker says the scored point lies; while LOST, where it last believed it.
  Errors add(const tracking::Track& track, const TrackTruth& truth, const Eigen::Vector2d& point);

  /// Its entries of summary.json:
  ///   lost_frames, uncertain_frames, relocks
  ///   wrong_ok_frames     called OK though the corners are over 5 px off, or the point over 8 px
  ///   score_lost_frames   LOST, or as far off; both null without truth
  ///   wrong_over_px       {corners, point}: the bounds that applied
  ///   error_px            {mean, std, max} of the corners, over the frames not LOST; null without truth
  ///   point_error_px      {name, frames, visible_frames, median, p95, mean, std, max, with_lost}: of the point over
  ///   the
  ///                       frames in which it is visible and the track is not LOST; with_lost {median, p95, max} has
  ///                       the LOST ones too, at the place last believed. null without a point
  ///   first_failure       {sequence, time_s, reason}: the first frame LOST ("lost") or as far off ("off"), or null
  nlohmann::json summary() const;

 private:
  TruthKind kind_;
  std::size_t lost_ = 0, uncertain_ = 0, relocks_ = 0, wrong_ok_ = 0, score_lost_ = 0, visible_ = 0;
  std::vector<double> corner_errors_px_, point_errors_px_, point_errors_with_lost_px_;
  nlohmann::json first_failure_;
};

}  // namespace heartservo::tools
