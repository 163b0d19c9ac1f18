#pragma once
// A picture drawn upright in the template's axes, so that candidates that only lie elsewhere are windows of one buffer,
// and the squared grey differences between such a window and the template.
#include <vector>

#include "tracking/camera/camera.hpp"
#include "tracking/planar/light.hpp"
#include "tracking/planar/patch.hpp"
#include "tracking/planar/search_picture.hpp"

namespace heartservo::tracking {

/// The template's grid with `margin` more points on every side, row by row.
struct UprightView {
  Patch grid;                ///< only width, height, step
  std::vector<float> grey;   ///< grey levels above the template's mean; 0 where not clear
  std::vector<float> clear;  ///< 1, or 0 outside the picture and at glare
  std::vector<float> scratch;
  static constexpr int kPad = 8;  ///< values that can be read behind the last

  std::size_t size() const { return static_cast<std::size_t>(grid.width) * static_cast<std::size_t>(grid.height); }
  /// Sets the grid; allocates only when it is larger than all before.
  void shape(const Patch& patch, int margin);
};

/// The template as windows are compared with it. Rows padded to whole vectors.
struct WindowTemplate {
  int width = 0, height = 0, stride = 0;
  float mean = 0;
  std::vector<float> grey, square;  ///< above the mean, and squared; 0 where unusable
  std::vector<float> usable;        ///< 1 or 0
  double points = 0;                ///< usable ones

  explicit WindowTemplate(const Patch& patch);
  WindowTemplate() = default;
};

/// Draws the view: G_plane_patch sends the grid's centre to where the template's centre lies for the window in the
/// view's middle. `mean`: WindowTemplate::mean.
void look(const SearchPicture& picture, int level, const Camera& camera, const Eigen::Matrix3d& G_plane_patch,
          Interpolation interpolation, float mean, UprightView& view);

struct WindowFit {
  double d = 1;  ///< in [0, 1]
  Light light;   ///< that gives the window the template's mean and contrast
};

/// The window's top left point is (x, y) of the view. Mean and variance of the two are made equal over the points
/// usable in both (so gain and bias do not matter); the squared differences then add up to 2 (1 - rho) per point, with
/// the correlation rho, and d = (1 - rho) / 2 is that sum normalised to [0, 1]. A plain window has d = 1/2, one with
/// too few usable points d = 1.
WindowFit fit_of(const WindowTemplate& reference, const UprightView& view, int x, int y);

}  // namespace heartservo::tracking
