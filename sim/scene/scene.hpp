#pragma once
// A scene: one YAML file that says all. Documented key by key in scenes/README.md, made from the lists below.
#include <Eigen/Core>
#include <string>
#include <vector>

#include "servo/loop/loop_options.hpp"
#include "sim/endoscope/occlusion.hpp"
#include "sim/endoscope/picture_options.hpp"
#include "sim/endoscope/tool_view.hpp"
#include "sim/experiment/depth_rail_options.hpp"
#include "sim/heart/ecg_options.hpp"
#include "sim/heart/heart_motion.hpp"
#include "sim/heart/heart_surface.hpp"
#include "sim/robot/robot_options.hpp"
#include "sim/scene/depth_scene.hpp"
#include "sim/tissue/kelvin_voigt.hpp"
#include "tracking/planar/planar_tracker.hpp"
#include "tracking/settings/fields.hpp"

namespace heartservo::sim {

struct CameraOptions {
  std::string calibration;  ///< file, relative to the scene's folder; "" for an assumed pinhole camera
  double frame_rate_hz = 125;
  double field_of_view_rad = 0.9;

  void fields(FieldVisitor& v) {
    v.field({"calibration", "", "camera file (ROS, OpenCV or ViSP), relative to the scene; empty: a pinhole camera"},
            calibration);
    v.field({"frame_rate_hz", "Hz", "frames per second; 0 for recorded frames: a video's own rate, else 25", 0, 10000},
            frame_rate_hz);
    v.field({"field_of_view_rad", "rad", "horizontal, of the assumed pinhole camera", 0.1, 2.5}, field_of_view_rad);
  }
};

/// Frames from disk instead of the simulated heart; the tool is virtual and drawn into them.
struct RecordingOptions {
  std::string source, right;
  double depth_m = 0.045;
  std::vector<double> roi;
  std::string reference, point;

  void fields(FieldVisitor& v) {
    v.field({"source", "", "image folder, printf pattern or video, relative to the scene; empty: the simulated heart"},
            source);
    v.field({"right", "",
             "the right view of a stereo endoscope, as source; camera.calibration must be a stereo file then; empty: one "
             "view"},
            right);
    v.field({"depth_m", "m", "assumed distance of the region from the camera", 1e-3, 10}, depth_m);
    v.field({"roi", "px",
             "region to follow in the first frame: x, y, width, height; further regions of the command track after it",
             -1e5, 1e5},
            roi, 0);
    v.field({"reference", "",
             "CSV with frame (from 1) or time_s, u_px, v_px, optionally point and visible: where points of the region "
             "truly "
             "are, or without names its centre, for the score; empty: scored against the tracked region"},
            reference);
    v.field({"point", "", "the point of recording.reference; empty: the one inside the region nearest to its centre"},
            point);
  }
};

/// The region of the simulated heart that the loop follows.
struct TargetOptions {
  int landmark = 0;
  double x_m = 0, y_m = 0, side_m = 0.005;
  double pick_error_px = 1;

  void fields(FieldVisitor& v) {
    v.field({"landmark", "", "index of the landmark to follow; -1: the tissue at x_m, y_m", -1, 100}, landmark);
    v.field({"x_m", "m", "centre of the tissue region, material coordinates", -0.03, 0.03}, x_m);
    v.field({"y_m", "m", "centre of the tissue region, material coordinates", -0.03, 0.03}, y_m);
    v.field({"side_m", "m", "side of the tissue region", 0.001, 0.05}, side_m);
    v.field({"pick_error_px", "px", "how far off the corners picked by hand in the first frame may be", 0, 10},
            pick_error_px);
  }
};

/// Engines by name.
struct EngineOptions {
  std::string tracker = "esm", estimator = "landmark_refined", predictor = "mixture", controller = "ibvs_feedforward";
  void fields(FieldVisitor& v);
};

struct Scene {
  std::string title;
  int seed = 1;
  double duration_s = 15.2, settle_s = 2;
  CameraOptions camera;
  RecordingOptions recording;
  HeartMotionOptions motion;
  EcgOptions ecg;
  HeartSurfaceOptions surface;
  TargetOptions target;
  std::vector<TargetOptions> more_targets;
  ScaleOptions depth;
  StereoViewOptions stereo;
  PictureOptions picture;
  ToolOptions tool;
  RobotOptions robot;
  TissueOptions tissue;
  std::vector<OcclusionOptions> occlusions;
  EngineOptions engines;
  tracking::TrackerOptions tracking;
  servo::LoopOptions loop;
  DepthRailOptions depth_rail;

  // Not keys: from the command line, or from where the scene lies.
  std::string folder = ".";    ///< where relative paths start
  std::size_t max_frames = 0;  ///< 0: all of them
  bool show_tool = true;       ///< false: a look at the heart alone

  /// Regions that `track` follows: the target and more_targets, or those of recording.roi.
  std::size_t region_count() const;
  bool is_recorded() const { return !recording.source.empty(); }
  std::size_t frame_count() const;
  void fields(FieldVisitor& v);
  /// Every problem at once, empty when the scene can be run.
  std::vector<std::string> validate() const;
};

/// Reads and validates a scene file. Throws InputError (file) or ConfigError (keys, values).
Scene load_scene(const std::string& file);

/// Throws ConfigError with all problems of the scene in one line, if there are any.
void require_valid(const Scene& scene, const std::string& where);

/// `path` as seen from the scene's folder.
std::string resolve(const Scene& scene, const std::string& path);

/// The camera of the scene. Throws InputError (file). `width`, `height`: of the pictures, for an assumed camera.
tracking::Camera camera_of(const Scene& scene, int width, int height);

}  // namespace heartservo::sim
