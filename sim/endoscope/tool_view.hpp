#pragma once
// The tool as the endoscope sees it: a tapering metal shaft with a painted square marker, drawn into any grey picture.
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "sim/endoscope/node_grid.hpp"
#include "tracking/camera/camera.hpp"
#include "tracking/settings/fields.hpp"

namespace heartservo::sim {

/// The marker's painted_pattern(); no landmark has it.
inline constexpr std::uint32_t kMarkerPattern = 1000;

struct ToolOptions {
  double radius_m = 0.0013;
  double taper_m = 0.006;
  Eigen::Vector3d direction{0.72, 0.57, -0.36};
  double marker_side_m = 0.004;
  Eigen::Vector3d marker_offset_m{0.0066, 0.0052, -0.0062};
  double brightness = 1;

  void fields(FieldVisitor& v) {
    v.field({"radius_m", "m", "of the shaft", 0.0002, 0.01}, radius_m);
    v.field({"taper_m", "m", "length over which the shaft tapers to its tip", 0.0005, 0.05}, taper_m);
    v.field({"direction", "", "from the tip along the shaft, camera frame; any length", -1, 1}, direction);
    v.field({"marker_side_m", "m", "side of the square marker, 0: none", 0, 0.02}, marker_side_m);
    v.field(
        {"marker_offset_m", "m", "marker's centre from the tip, camera frame; its plate faces the camera", -0.05, 0.05},
        marker_offset_m);
    v.field({"brightness", "", "of shaft and marker", 0, 3}, brightness);
  }

  /// Every problem at once, empty when usable: among others the marker must lie before the shaft and off the tip.
  std::vector<std::string> validate() const;
};

/// Where the tool is: its tip, and how far it has turned from the options' direction and marker; camera frame, m.
struct ToolPose {
  Eigen::Vector3d tip;
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  ToolPose(const Eigen::Vector3d& tip_camera) : tip(tip_camera) {}  // NOLINT: a tip is a pose of a tool unturned
  ToolPose(const Eigen::Vector3d& tip_camera, const Eigen::Matrix3d& turn_camera)
      : tip(tip_camera), turn(turn_camera) {}
};

/// Corners of the marker, camera frame, m, clockwise from top left.
std::array<Eigen::Vector3d, 4> marker_corners(const ToolOptions& options, const ToolPose& pose);

/// Draws tools through one camera; keeps what depends on the camera only. Not to be shared between threads except
/// through paint_row().
class ToolView {
 public:
  /// Throws ConfigError on options that do not validate.
  ToolView(const tracking::Camera& camera, const ToolOptions& options);

  /// A tip behind the camera hides the tool.
  void place(const ToolPose& pose);

  /// Pixels of the tool in row v: first and last + 1; equal when the row is free of it.
  std::array<int, 2> reach(int v) const;

  /// Cover 0..1 and grey level of the tool on the pixels of reach(v), written from index 0. `work` holds work_size()
  /// values.
  void paint_row(int v, float* cover, float* grey, float* work) const;
  std::size_t work_size() const { return 2 * static_cast<std::size_t>(grid_.padded_width() + grid_.columns()); }

 private:
  tracking::Camera camera_;
  ToolOptions options_;
  Eigen::Vector3d direction_, rest_direction_;
  NodeGrid grid_;
  std::vector<float> rays_;
  std::vector<float> marker_;  // grey and cover, kMarkerTexels^2 each
  Eigen::Vector3d tip_{0, 0, -1};
  Eigen::Matrix3d turn_ = Eigen::Matrix3d::Identity();
  int left_ = 0, right_ = 0, top_ = 0, bottom_ = 0;  // px, end exclusive
};

/// Draws the tool into `grey` (CV_8UC1, the camera's size) and, unless null, `colour` (CV_8UC3). Exact to the distorted
/// camera; edges are anti-aliased. For pictures of any source; for many of them keep a ToolView.
void draw_tool(const tracking::Camera& camera, const ToolOptions& options, const ToolPose& pose, cv::Mat& grey,
               cv::Mat* colour);
void draw_tool(ToolView& view, const ToolPose& pose, cv::Mat& grey, cv::Mat* colour);

}  // namespace heartservo::sim
