#pragma once
// The region of the left picture found in the right one, along its epipolar line, to a small part of a pixel: depth.
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tracking/camera/stereo_camera.hpp"
#include "tracking/planar/image_pyramid.hpp"
#include "tracking/settings/fields.hpp"

namespace heartservo::tracking {

struct StereoOptions {
  double nearest_m = 0.02, farthest_m = 0.2;  ///< distances looked for
  double window_px = 81;                      ///< longest side of the part of the region, at its centre, that is matched
  double epipolar_sigma_px = 0.5;             ///< of the calibration, across the epipolar lines
  double ok_correlation = 0.8;                ///< at least this: OK
  double uncertain_correlation = 0.6;         ///< at least this: UNCERTAIN; below: no match

  void fields(FieldVisitor& v) {
    v.field({"nearest_m", "m", "nearest distance looked for in the second view", 1e-3, 10}, nearest_m);
    v.field({"farthest_m", "m", "farthest distance looked for in the second view", 1e-3, 10}, farthest_m);
    v.field({"window_px", "px", "longest side of the part of the region, at its centre, that is matched", 15, 400},
            window_px);
    v.field({"epipolar_sigma_px", "px", "error of the stereo calibration across the epipolar lines", 0.01, 20},
            epipolar_sigma_px);
    v.field({"ok_correlation", "", "correlation of the two views from which a match is sure", 0, 1}, ok_correlation);
    v.field({"uncertain_correlation", "", "correlation of the two views below which there is no match", 0, 1},
            uncertain_correlation);
  }

  /// Every problem at once; empty when usable.
  std::vector<std::string> validate() const;
};

enum class StereoFailure { NONE, OUT_OF_PICTURE, NOT_FOUND, AMBIGUOUS, BAD_FIT, OFF_EPIPOLAR };
const char* name_of(StereoFailure failure);

struct StereoMatch {
  StereoFailure failure = StereoFailure::NOT_FOUND;  ///< unless NONE, nothing below is valid
  double depth_m = 0;                                ///< z of the region's centre in the left camera's frame
  double sigma_m = 0;  ///< its standard deviation from the pictures' noise; the calibration's error is not in it
  /// Of 1 / z over the normalised plane of the left camera, at the centre: 1/z = 1/depth + gradient . (n - centre) + ...
  Eigen::Vector2d gradient = Eigen::Vector2d::Zero();
  double correlation = 0;  ///< zero-mean normalised, of what is believed
  double visible = 0;      ///< share of the region that lies in the right picture and fits
  double epipolar_px = 0;  ///< how far off the epipolar line it was found
  double noise_grey = 0;   ///< robust standard deviation of the remaining difference
};

/// Keeps its memory between frames; not for two threads at once.
class StereoMatcher {
 public:
  /// Throws ConfigError where the camera or the options do not validate.
  StereoMatcher(const StereoCamera& camera, const StereoOptions& options);
  ~StereoMatcher();

  /// `G_plane_patch`: the region in the left picture, patch coordinates [-1, 1] x [-1, 1] to the normalised plane (see
  /// patch.hpp); `side_px`: about its longer side. `near`: the last match, to look around it first. Pictures: 8-bit
  /// grey of the cameras' size.
  StereoMatch match(const cv::Mat& left, const cv::Mat& right, const Eigen::Matrix3d& G_plane_patch, double side_px,
                    const std::optional<StereoMatch>& near = std::nullopt);

  const StereoCamera& camera() const;

 private:
  struct Workspace;
  std::unique_ptr<Workspace> w_;
};

}  // namespace heartservo::tracking
