#pragma once
#include "tracking/planar/upright_view.hpp"
#include "tracking/texture/sliding_texture.hpp"
#include "tracking/texture/texture_vector.hpp"

namespace heartservo::tracking {

/// How the texture of windows of a view differs from the template's. Grey levels divide the template's own range, its
/// mean and 2.5 standard deviations to either side; the picture's are brought to its light first.
class RoiTexture {
 public:
  RoiTexture() : RoiTexture(16, UprightView{}, 0) {}
  /// `reference`: the view of the template itself, without margin; `mean` is that of look().
  RoiTexture(int levels, const UprightView& reference, float mean);

  /// The windows to come are those of this view.
  void load(const UprightView& view, const Light& light);

  /// t of eq. (10) between template and window; `x`, `y` as of fit_of(). Windows one point apart are cheap: the
  /// matrices are carried along, a column out, a column in.
  double distance(int x, int y);

  const TextureVector& reference() const { return reference_; }

 private:
  void quantise(const UprightView& view, const Light& light);

  int levels_;
  float mean_;
  float low_ = 0, high_ = 255;
  LevelImage image_;
  SlidingTexture sliding_;
  TextureVector reference_{};
  bool placed_ = false;
};

}  // namespace heartservo::tracking
