#pragma once
#include "tracking/camera/camera.hpp"
#include "tracking/planar/planar_tracker.hpp"
#include "tracking/planar/target_tracker.hpp"
#include "tracking/settings/registry.hpp"

namespace heartservo::tracking {

/// Trackers by name.
const Registry<TargetTracker, const Camera&, const TrackerOptions&>& trackers();

}  // namespace heartservo::tracking
