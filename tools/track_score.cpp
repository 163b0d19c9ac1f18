#include "tools/track_score.hpp"

#include "servo/loop/score.hpp"

namespace heartservo::tools {

using nlohmann::json;
using tracking::TrackState;

TrackScore::Errors TrackScore::add(const tracking::Track& track, const TrackTruth& truth,
                                   const Eigen::Vector2d& point) {
  const bool lost = track.state == TrackState::LOST;
  Errors errors;
  if (truth.corners && !lost) {
    errors.corners_px = 0;
    for (std::size_t i = 0; i < 4; ++i) errors.corners_px += (track.corners[i] - (*truth.corners)[i]).norm() / 4;
    corner_errors_px_.push_back(errors.corners_px);
  }
  visible_ += truth.point.allFinite();
  if (const double off_px = (point - truth.point).norm(); std::isfinite(off_px)) {
    point_errors_with_lost_px_.push_back(off_px);
    if (!lost) point_errors_px_.push_back(errors.point_px = off_px);
  }
  // written so that a NaN of a tracker counts as wrong
  const bool corners_off = truth.corners && !lost && !(errors.corners_px <= kWrongCorners_px);
  const bool point_off = truth.point.allFinite() && !lost && !(errors.point_px <= kWrongPoint_px);
  const bool off = corners_off || point_off;
  lost_ += lost;
  uncertain_ += track.state == TrackState::UNCERTAIN;
  relocks_ += track.reacquired;
  wrong_ok_ += off && track.state == TrackState::OK;
  score_lost_ += off || lost;
  if ((off || lost) && first_failure_.is_null())
    first_failure_ = {{"sequence", track.sequence}, {"time_s", track.time_s}, {"reason", lost ? "lost" : "off"}};
  return errors;
}

json TrackScore::summary() const {
  const bool known = kind_.corners || kind_.point;
  json j{{"lost_frames", lost_},
         {"uncertain_frames", uncertain_},
         {"relocks", relocks_},
         {"wrong_ok_frames", known ? json(wrong_ok_) : json()},
         {"score_lost_frames", known ? json(score_lost_) : json()},
         {"wrong_over_px", known ? json::object() : json()},
         {"error_px", nullptr},
         {"point_error_px", nullptr},
         {"first_failure", first_failure_}};
  if (kind_.corners) j["wrong_over_px"]["corners"] = kWrongCorners_px;
  if (kind_.point) j["wrong_over_px"]["point"] = kWrongPoint_px;
  if (!corner_errors_px_.empty()) {
    const auto e = servo::spread_of(corner_errors_px_);
    j["error_px"] = {{"mean", e.mean}, {"std", e.std}, {"max", e.max}};
  }
  if (!kind_.point) return j;
  const auto e = servo::spread_of(point_errors_px_), all = servo::spread_of(point_errors_with_lost_px_);
  const auto value = [](const servo::Spread& of, double v) { return of.count > 0 ? json(v) : json(); };
  j["point_error_px"] = {{"name", *kind_.point},
                         {"frames", e.count},
                         {"visible_frames", visible_},
                         {"median", value(e, servo::percentile(point_errors_px_, 50))},
                         {"p95", value(e, e.p95)},
                         {"mean", value(e, e.mean)},
                         {"std", value(e, e.std)},
                         {"max", value(e, e.max)},
                         {"with_lost",
                          {{"median", value(all, servo::percentile(point_errors_with_lost_px_, 50))},
                           {"p95", value(all, all.p95)},
                           {"max", value(all, all.max)}}}};
  return j;
}

}  // namespace heartservo::tools
