#pragma once
// What a loop runs on: a source of frames and a robot, simulated or recorded. Beside them, out of the loop's reach,
// what truly was.
#include <Eigen/Core>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "servo/ecg/ecg_monitor.hpp"
#include "servo/loop/score.hpp"
#include "servo/robot/tool_robot.hpp"
#include "tracking/camera/camera.hpp"
#include "tracking/camera/stereo_camera.hpp"
#include "tracking/depth/scale_source.hpp"
#include "tracking/frames/frame_source.hpp"
#include "tracking/planar/quad.hpp"

namespace heartservo::servo {
struct LoopRecord;
}

namespace heartservo::sim {

struct Scene;

/// What a person would give the loop at the start: the regions picked in the first frame.
struct HandPicked {
  tracking::Quad target, marker;
  /// Painted plates have an edge to refine the corners on: its side relative to the plate's; 0 for bare tissue.
  double target_edge_ratio = 0, marker_edge_ratio = 0;
  /// How the target's distance becomes known once, as the scene's depth.source says; empty where it does not.
  tracking::ScaleSource scale;
  /// What was printed on the plates, as landmark_template.hpp wants it; the target's is empty for bare tissue.
  cv::Mat target_plate, marker_plate;
};

class Table {
 public:
  virtual ~Table() = default;
  virtual tracking::FrameSource& frames() = 0;
  virtual servo::ToolRobot& robot() = 0;
  virtual const tracking::Camera& camera() const = 0;
  /// Of a region of the scene (Scene::region_count()); the loop follows the first. The same holds below.
  virtual HandPicked picked(std::size_t region = 0) const = 0;
  /// Both cameras, where the frames have a right view.
  virtual std::optional<tracking::StereoCamera> stereo() const { return std::nullopt; }
  virtual Eigen::Vector3d marker_to_tip() const = 0;  ///< m, camera frame; the tool does not turn
  virtual Eigen::Vector3d tool_axis() const = 0;      ///< from the tip along the shaft, camera frame
  virtual Eigen::Vector3d offset() const = 0;         ///< surgeon's offset in the target frame, m
  virtual double region_side_m(std::size_t region = 0) const = 0;  ///< of the square region followed; 0: unknown
  virtual double marker_side_m() const = 0;
  /// For the score. Call it after the loop's step, with what that step recorded.
  virtual servo::TruthSample truth(const servo::LoopRecord& record, std::size_t region = 0) const = 0;
  virtual std::string reference() const = 0;  ///< what the pixel residual is scored against: truth, tracked or a file
  /// The ECG beside the frames, from its beginning; null where the scene has none.
  virtual std::unique_ptr<servo::EcgSource> ecg() const { return nullptr; }
  /// When the heart truly beats: R peaks, s; empty where nobody knows. For the score and for files.
  virtual std::vector<double> beats() const { return {}; }
  virtual std::string reference_point() const { return ""; }  ///< the point of that file; "" where it names none
};

/// The simulated heart, or the recorded sequence that the scene names. `opened`: that sequence, where it is open
/// already. Throws InputError, ConfigError.
std::unique_ptr<Table> make_table(const Scene& scene, std::unique_ptr<tracking::FrameSource> opened = nullptr);

std::unique_ptr<Table> make_operating_table(const Scene& scene);
std::unique_ptr<Table> make_recorded_table(const Scene& scene, std::unique_ptr<tracking::FrameSource> opened = nullptr);

/// The left view of the sequence that the scene names. Throws InputError; of a camera DeviceError.
std::unique_ptr<tracking::FrameSource> open_recording(const Scene& scene);

}  // namespace heartservo::sim
