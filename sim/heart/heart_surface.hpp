#pragma once
// The heart's visible surface: material coordinates -> 3D points in the camera frame at any time, in closed form.
//
// A curved sheet, moved by HeartMotion (displacement, and rotation about the anchor), deformed in step with the beat
// by smooth waves in the sheet and across it. Landmarks are stiff plates: under a plate the sheet is planar and rigid.
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "sim/heart/heart_motion.hpp"
#include "sim/heart/landmark_options.hpp"
#include "sim/heart/surface_state.hpp"

namespace heartservo::sim {

struct HeartSurfaceOptions {
  Eigen::Vector3d anchor_m{0, 0, 0.055};
  double radius_m = 0.05;
  double slope_limit = 0.5;
  double strain = 0.05;
  double wavelength_m = 0.028;
  double bulge_m = 0.0004;
  double plate_blend_m = 0.004;
  std::vector<LandmarkOptions> landmarks;

  void fields(FieldVisitor& v) {
    v.field({"anchor_m", "m", "mean position of the heart's spot a = b = 0, camera frame", -0.2, 0.5}, anchor_m);
    v.field({"radius_m", "m", "radius of curvature at the anchor", 0.02, 10}, radius_m);
    v.field({"slope_limit", "", "slope of the surface far from the anchor", 0.05, 1}, slope_limit);
    v.field({"strain", "", "largest strain of the tissue in a beat, about", 0, 0.2}, strain);
    v.field({"wavelength_m", "m", "of the deformation, about", 0.015, 0.2}, wavelength_m);
    v.field({"bulge_m", "m", "amplitude of each of two waves of deformation across the surface", 0, 0.003}, bulge_m);
    v.field({"plate_blend_m", "m", "width of the tissue that adapts to a landmark's plate", 0.002, 0.02},
            plate_blend_m);
    v.list("landmarks", "stiff painted plates on the tissue", landmarks);
  }

  /// Every problem at once, empty when usable. Landmarks must not reach into each other's blend.
  std::vector<std::string> validate() const;
};

class HeartSurface {
 public:
  /// The seed draws the directions and phases of the waves. Throws ConfigError on options that do not validate.
  HeartSurface(const HeartSurfaceOptions& options, HeartMotion motion, std::uint64_t seed);

  /// The surface at time t; point() and the renderer work on it.
  SurfaceState at(double t) const;
  void at(double t, SurfaceState& state) const;  ///< reuses the state's memory

  /// Point of the tissue (or plate), camera frame, m.
  Eigen::Vector3d point(double a, double b, double t) const { return at(t).point(a, b); }

  /// Frame on the tissue: origin at (a, b), x and y as near as an orthonormal pair can be to the directions in which a
  /// and b grow, z away from the camera at rest. On a plate: fixed to it, parallel to T_camera_landmark but for its
  /// angle.
  Eigen::Isometry3d T_camera_point(double a, double b, double t) const;

  /// Frame of landmark i: origin at the plate's centre, x right, y down, z away from the camera at rest.
  Eigen::Isometry3d T_camera_landmark(std::size_t i, double t) const;

  /// Corners of landmark i, camera frame, clockwise from top left as seen by the camera (for a zero angle).
  std::array<Eigen::Vector3d, 4> landmark_corners(std::size_t i, double t) const;

  std::size_t landmark_count() const { return options_.landmarks.size(); }
  const HeartMotion& motion() const { return motion_; }
  const HeartSurfaceOptions& options() const { return options_; }

 private:
  struct ModeShape {
    DeformationMode wave;    // amplitude at full strength
    double lag, second_lag;  // cycles
  };

  HeartSurfaceOptions options_;
  HeartMotion motion_;
  std::array<ModeShape, kDeformationModes> shapes_;
};

}  // namespace heartservo::sim
