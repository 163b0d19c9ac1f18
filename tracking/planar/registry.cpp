#include "tracking/planar/registry.hpp"

#include "tracking/planar/composite_aligner.hpp"
#include "tracking/planar/correlation_aligner.hpp"
#include "tracking/planar/deformable_aligner.hpp"
#include "tracking/planar/esm_aligner.hpp"
#include "tracking/planar/optical_flow_aligner.hpp"
#include "tracking/planar/ssd_aligner.hpp"
#include "tracking/planar/visp_aligner.hpp"

namespace heartservo::tracking {

namespace {

std::unique_ptr<TargetTracker> make_esm(const Camera& camera, const TrackerOptions& options) {
  EsmOptions esm;
  esm.max_iterations = options.max_iterations;
  return std::make_unique<PlanarTracker>(make_esm_aligner(esm), camera, options);
}

std::unique_ptr<TargetTracker> make_composite(const Camera& camera, const TrackerOptions& options) {
  EsmOptions esm;
  esm.max_iterations = options.max_iterations;
  return std::make_unique<PlanarTracker>(make_composite_aligner(options.composite, esm), camera, options);
}

std::unique_ptr<TargetTracker> make_ssd(const Camera& camera, const TrackerOptions& options) {
  SsdOptions ssd;
  ssd.max_iterations = options.max_iterations;
  return std::make_unique<PlanarTracker>(make_ssd_aligner(ssd), camera, options);
}

std::unique_ptr<TargetTracker> make_correlation(const Camera& camera, const TrackerOptions& options) {
  return std::make_unique<PlanarTracker>(make_correlation_aligner({options.search_px}), camera, options);
}

std::unique_ptr<TargetTracker> make_optical_flow(const Camera& camera, const TrackerOptions& options) {
  return std::make_unique<PlanarTracker>(make_optical_flow_aligner({}), camera, options);
}

std::unique_ptr<TargetTracker> make_deformable(const Camera& camera, const TrackerOptions& options) {
  DeformableOptions deformable;
  deformable.max_iterations = options.max_iterations;
  return std::make_unique<PlanarTracker>(make_deformable_aligner(deformable), camera, options);
}

// ViSP's trackers see pixels only, so no camera: under a lens they follow a homography of the distorted picture.
template <VispMethod method>
std::unique_ptr<TargetTracker> make_visp(const Camera&, const TrackerOptions& options) {
  return std::make_unique<PlanarTracker>(make_visp_aligner(method), Camera{}, options);
}

}  // namespace

const Registry<TargetTracker, const Camera&, const TrackerOptions&>& trackers() {
  static const Registry<TargetTracker, const Camera&, const TrackerOptions&> registry(
      "tracker",
      {{"esm", "homography by efficient second-order minimisation, gain and bias, robust", make_esm},
       {"composite", "candidates by squared differences and texture, then the homography as esm", make_composite},
       {"deformable", "as esm, then a smooth bending of the region by splines", make_deformable},
       {"ssd", "homography by Gauss-Newton on the squared differences, no gain, not robust", make_ssd},
       {"correlation", "translation by zero-mean normalised correlation, exhaustive", make_correlation},
       {"optical_flow", "homography from pyramidal Lucas-Kanade, chained from frame to frame", make_optical_flow},
       {"visp_esm", "ViSP's SSD, efficient second-order; pixels only, no lens", make_visp<VispMethod::ESM>},
       {"visp_ic", "ViSP's SSD, inverse compositional; pixels only, no lens", make_visp<VispMethod::IC>},
       {"visp_zncc", "ViSP's normalised correlation; pixels only, no lens", make_visp<VispMethod::ZNCC>},
       {"visp_mi", "ViSP's mutual information, slow; pixels only, no lens", make_visp<VispMethod::MI>}});
  return registry;
}

}  // namespace heartservo::tracking
