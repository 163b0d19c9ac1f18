#include "tracking/planar/registry.hpp"

#include "tracking/planar/esm_aligner.hpp"

namespace heartservo::tracking {

namespace {

std::unique_ptr<TargetTracker> make_esm(const Camera& camera, const TrackerOptions& options) {
  EsmOptions esm;
  esm.max_iterations = options.max_iterations;
  return std::make_unique<PlanarTracker>(make_esm_aligner(esm), camera, options);
}

}  // namespace

const Registry<TargetTracker, const Camera&, const TrackerOptions&>& trackers() {
  static const Registry<TargetTracker, const Camera&, const TrackerOptions&> registry(
      "tracker", {{"esm", "homography by efficient second-order minimisation, gain and bias, robust", make_esm}});
  return registry;
}

}  // namespace heartservo::tracking
