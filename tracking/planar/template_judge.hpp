#pragma once
// The template of an aligner that does not weigh or light-correct its own points, and the same judgement for all of
// them: gain and bias by least squares, Tukey weights on what remains, correlation and visible share under these
// weights, exactly what EsmAligner reports. So a peer that stands still on the wrong place is called lost by the same
// thresholds as ours.
#include <vector>

#include "tracking/planar/normal_equations.hpp"
#include "tracking/planar/patch_aligner.hpp"

namespace heartservo::tracking {

class TemplateJudge {
 public:
  void learn(const ImagePyramid& picture, const Camera& camera, const Eigen::Matrix3d& G_plane_patch, int side_x,
             int side_y);

  int levels() const { return static_cast<int>(patches_.size()); }
  /// At `level` or the coarsest one there is.
  const Patch& patch(int level) const;
  /// Number of usable points of a level.
  double usable(int level) const { return references_[static_cast<std::size_t>(level)].usable; }
  const Camera& camera() const { return camera_; }
  /// Half the longer side of the region: px of the picture per unit of patch coordinate where it was learnt.
  double half_side_px() const { return half_side_px_; }

  /// Fills everything of `a` but its position and iterations, from its position. `converged` is false where the region
  /// does not lie in the picture.
  void judge(const ImagePyramid& picture, Alignment& a);

  /// Plain zero-mean normalised correlation of template and picture at G_plane_patch; 0 where it cannot be had.
  double correlation_at(const ImagePyramid& picture, const Eigen::Matrix3d& G_plane_patch);

 private:
  void sample(const ImagePyramid& picture, const Eigen::Matrix3d& G_plane_patch);

  Camera camera_;
  std::vector<Patch> patches_;
  std::vector<simd::EsmTemplate> references_;  // of each patch
  AlignmentBuffers buffers_;
  double half_side_px_ = 1;
};

}  // namespace heartservo::tracking
