#pragma once
// What `track` scores against, by where it comes from.
#include <functional>
#include <string>

#include "sim/table/point_tracks.hpp"
#include "tools/corner_truth.hpp"
#include "tools/track_score.hpp"

namespace heartservo::servo {
struct TruthSample;
}
namespace heartservo::sim {
class Table;
}
namespace heartservo::tracking {
struct Frame;
}

namespace heartservo::tools {

struct TruthSource {
  std::string reference;  ///< "truth", a file, or "" where nothing is known
  TruthKind kind;
  std::function<TrackTruth(const tracking::Frame&)> at = [](const tracking::Frame&) { return TrackTruth{}; };
};

/// px: where the centre of the region truly lies. The table must know the truth.
Eigen::Vector2d true_target_px(const sim::Table& table, const servo::TruthSample& truth);

/// Of a simulated scene or an artificial sequence: corners, and the centre as a point called "target". Nothing of a
/// recorded one. `table` must outlive the result.
TruthSource truth_of(const sim::Table& table, std::size_t region = 0);

/// The same from a file; the point where the file has it. `truth` must outlive the result.
TruthSource truth_of(const CornerTruth& truth, const std::string& file);

/// Adds an annotated point, in place of another.
void add_point(TruthSource& source, const std::string& file, const sim::PointTrack& point);

}  // namespace heartservo::tools
