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

  /// Looks from `view_m` from now on, without turning; all else stays given in the first camera frame. The lamp moves by
  /// `lamp_m`: as far as the view where the robot carries the endoscope, as far as the left endoscope for the right view
  /// of a stereo pair.
  void move_view(const Eigen::Vector3d& view_m, const Eigen::Vector3d& lamp_m = Eigen::Vector3d::Zero());

  std::shared_ptr<const TissueTexture> texture() const { return texture_; }

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
  Eigen::Vector3d view_m_ = Eigen::Vector3d::Zero();
  ToolView tool_;
  SurfaceState state_;
  std::unique_ptr<Workspace> workspace_;
};

}  // namespace heartservo::sim
