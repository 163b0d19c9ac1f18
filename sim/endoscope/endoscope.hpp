#pragma once
// The endoscope's grey picture of the heart's surface, and of a tool before it.
#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "sim/endoscope/picture_options.hpp"
#include "sim/endoscope/surface_nodes.hpp"
#include "sim/endoscope/tissue_texture.hpp"
#include "sim/endoscope/tool_view.hpp"
#include "sim/heart/heart_surface.hpp"
#include "tracking/camera/camera.hpp"

namespace heartservo::sim {

/// One picture at a time (render() itself works on several cores); pictures depend on time, frame index and options
/// only, not on what was rendered before or on the number of threads.
class Endoscope {
 public:
  /// Keeps a copy of the surface. Without a texture, procedural tissue with the surface's landmarks is made from the
  /// options and the seed, which also draws the noise. Throws ConfigError on options that do not validate.
  Endoscope(const tracking::Camera& camera, const HeartSurface& surface, const PictureOptions& options,
            std::uint64_t seed, const ToolOptions& tool = {}, std::shared_ptr<const TissueTexture> texture = nullptr);
  ~Endoscope();

  /// Picture at time t (s) into `grey` (CV_8UC1 of the camera's size, allocated if it is not). `tool`: null for
  /// none. Noise is that of `frame_index`.
  void render(double t, std::uint64_t frame_index, cv::Mat& grey, const ToolPose* tool = nullptr);

  /// Moves the endoscope: it takes its pictures from `shift` (m) off its first place, without turning. The tool is not
  /// moved with it: its pose stays relative to the camera.
  void move_to(const Eigen::Vector3d& shift) { shift_ = shift; }

  /// Changes exposure from now on: lamp, gain drift, automatic control. 1 and the options' bias at first.
  void set_light(double gain, double bias_grey);

  const HeartSurface& surface() const { return surface_; }
  const tracking::Camera& camera() const { return camera_; }

 private:
  struct Workspace;

  tracking::Camera camera_;
  HeartSurface surface_;
  PictureOptions options_;
  std::shared_ptr<const TissueTexture> texture_;
  SurfaceNodes nodes_;
  ToolView tool_;
  SurfaceState state_;
  Eigen::Vector3d shift_ = Eigen::Vector3d::Zero();
  std::unique_ptr<Workspace> workspace_;
};

}  // namespace heartservo::sim
