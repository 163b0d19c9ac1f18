#pragma once
// Section 4.1, depth precision: a landmark moves along the camera's axis, parallel to the picture and at several tilts,
// through the working volume; its depth by each estimator is compared with that of a simulated laser of the paper's
// precision, and with the truth, which no estimator sees.
#include <functional>
#include <string>
#include <vector>

#include "servo/loop/score.hpp"

namespace heartservo::sim {

struct Scene;

/// One estimator at one tilt, or over all of them. Errors: estimate minus reference, m, camera frame.
struct DepthRailRow {
  std::string estimator;
  double tilt_rad = 0;
  bool all_tilts = false;
  std::size_t frames = 0, lost = 0;  ///< a LOST frame has no error; none is dropped unseen
  servo::Spread against_laser;       ///< of z
  servo::Spread x, y, z;             ///< against the truth
};

/// Estimators of the experiment, in the order of their rows: the paper's linear pose, IPPE with refinement, dense.
const std::vector<std::string>& depth_rail_estimators();

/// Rows by tilt, then by estimator; at last over all tilts. The scene needs motion.profile rail, a landmark as target
/// and depth_rail.tilts_rad. All estimators work on the same frames and the same track. `go_on`: called after every
/// frame with the number done; false ends the experiment early, with what there is. Throws ConfigError when the region
/// cannot be tracked.
std::vector<DepthRailRow> run_depth_rail(const Scene& scene, const std::function<bool(std::size_t)>& go_on);

}  // namespace heartservo::sim
