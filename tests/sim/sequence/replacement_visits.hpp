#pragma once
// What a tracker says while its region is gone, and once it is back (replaced_region.hpp), counted over visits.
#include <algorithm>
#include <functional>
#include <string>

#include "tests/sim/sequence/replaced_region.hpp"
#include "tracking/planar/registry.hpp"

namespace heartservo::test {

struct Visits {
  int gone = 60;   ///< frames without the region, per visit
  int there = 17;  ///< frames with it
  int visits = 3;  ///< how often it goes and comes back
};

struct VisitCount {
  std::string refused;  ///< why the tracker did not start
  int frames_gone = 0;
  int false_ok = 0, uncertain = 0;  ///< of the frames in which it is gone
  int wrong = 0;                    ///< frames called OK over 5 px off while it is there
  int to_lost = 0;                  ///< frames until LOST is said and kept, the largest of all visits
  int to_ok = 0;                    ///< frames until OK within 3 px of the truth, the largest of all visits
  int never_lost = 0, never_ok = 0, visits = 0;
};

using WatchFrame = std::function<void(int frame_of_visit, const tracking::Track&, double error_px)>;

inline double mean_corner_error_px(const tracking::Track& track, const tracking::Quad& truth) {
  double sum = 0;
  for (std::size_t i = 0; i < 4; ++i) sum += (track.corners[i] - truth[i]).norm() / 4;
  return sum;
}

/// Adds to `c`. `not_lost` hears of every frame that is not LOST while the region is gone.
inline void count_visits(const Visits& o, const std::string& name, ReplacedRegion& picture, VisitCount& c,
                         const WatchFrame& not_lost = {}) {
  constexpr int kWellAfter = 20;  // frames; what is not LOST later is counted as false OK or uncertain only
  const auto tracker = tracking::trackers().make(name, tracking::Camera{}, tracking::TrackerOptions{});
  std::size_t k = 0;
  c.refused = tracker->start(picture.frame(k++, false), picture.region());
  if (!c.refused.empty()) return;
  for (int i = 0; i < o.there; ++i) tracker->track(picture.frame(k++, false));
  for (int visit = 0; visit < o.visits; ++visit, ++c.visits) {
    int last_not_lost = 0;
    for (int i = 1; i <= o.gone; ++i, ++k, ++c.frames_gone) {
      const tracking::Track track = tracker->track(picture.frame(k, true));
      c.false_ok += track.state == tracking::TrackState::OK;
      c.uncertain += track.state == tracking::TrackState::UNCERTAIN;
      if (track.state == tracking::TrackState::LOST) continue;
      if (not_lost) not_lost(i, track, mean_corner_error_px(track, picture.corners(k)));
      if (i < kWellAfter) last_not_lost = i;
    }
    c.never_lost += last_not_lost >= kWellAfter - 1;
    c.to_lost = std::max(c.to_lost, last_not_lost + 1);
    int needed = 0;
    for (int i = 1; i <= o.there; ++i, ++k) {
      const tracking::Track track = tracker->track(picture.frame(k, false));
      const double error = mean_corner_error_px(track, picture.corners(k));
      const bool ok = track.state == tracking::TrackState::OK;
      c.wrong += ok && !(error < 5);
      if (!needed && ok && error < 3) needed = i;
    }
    c.never_ok += needed == 0;
    c.to_ok = std::max(c.to_ok, needed);
  }
}

}  // namespace heartservo::test
