#pragma once
// Aligns a template with a picture. A tracker (planar_tracker.hpp) wraps an aligner with prediction, states and
// re-acquisition, so that every aligner gets the same loss detection.
#include <Eigen/Core>
#include <algorithm>
#include <memory>
#include <opencv2/core/mat.hpp>

#include "tracking/camera/camera.hpp"
#include "tracking/planar/image_pyramid.hpp"
#include "tracking/planar/patch.hpp"

namespace heartservo::tracking {

/// A column for each control point: its offset x, y in patch coordinates, and by how much the gain is larger there.
/// Never on the heap: candidates are compared and copied in every frame.
inline constexpr int kMaxBendPoints = 64;
using BendField = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kMaxBendPoints>;

/// Where the template lies in a picture, and how well it fits there.
struct Alignment {
  bool converged = false;  ///< false: singular, out of the picture, or not finite
  Eigen::Matrix3d G_plane_patch = Eigen::Matrix3d::Identity();
  double gain = 1, bias = 0;   ///< template = gain * picture + bias
  double correlation = 0;      ///< zero-mean normalised, over the points believed, -1..1
  double correlation_all = 0;  ///< the same over all points but saturated ones
  double visible = 0;          ///< share of the template's usable points that lie in the picture and fit (not occluded)
  double noise_grey = 0;       ///< robust standard deviation of the remaining difference
  int iterations = 0;
  /// How the region is bent before the homography is applied, and lit, of aligners that bend it (spline_bend.hpp); none
  /// where the region is plane. It leaves the patch's centre in place, and G_plane_patch is the homography there.
  BendField bend{3, 0};

  /// The correlation, lowered where less than half of the template is believed.
  double fit() const { return correlation * std::min(1.0, visible / 0.5); }
};

/// How much a region may change its shape in the picture.
enum class MotionModel { TRANSLATION = 2, AFFINE = 6, HOMOGRAPHY = 8 };  // the number of parameters of SL(3) in use

class PatchAligner {
 public:
  virtual ~PatchAligner() = default;

  /// Learns the template from the picture; `side_x`, `side_y` are the region's sides in px.
  virtual void learn(const ImagePyramid& picture, const Camera& camera, const Eigen::Matrix3d& G_plane_patch,
                     int side_x, int side_y) = 0;

  /// Starts from `start`; its position, gain and bias are used. Uses the pyramid levels from `coarsest` down to 0, the
  /// model only at level 0 (a coarse level is affine at most).
  virtual Alignment align(const ImagePyramid& picture, const Alignment& start, int coarsest, MotionModel model) = 0;

  /// The template at a pyramid level.
  virtual const Patch& patch(int level) const = 0;

  /// Where the point of the patch lies, in patch coordinates, once the region is bent by the alignment.
  virtual Eigen::Vector2d bent(const Alignment& /*alignment*/, const Eigen::Vector2d& patch_point) const {
    return patch_point;
  }
  /// The gain there.
  virtual double gain_at(const Alignment& alignment, const Eigen::Vector2d& /*patch_point*/) const {
    return alignment.gain;
  }

  /// False: align() ignores the MotionModel, so that asking again with another one finds nothing new.
  virtual bool obeys_model() const { return true; }

  // For aligners that need more than the pyramid's window, or carry something from frame to frame.

  /// The whole 8-bit picture, before it is aligned with; valid until the next call. Comes before learn(), too.
  virtual void see(const cv::Mat& /*grey*/) {}
  /// `alignment` is where the tracker believes the region to be in the picture last seen.
  virtual void believe(const Alignment& /*alignment*/) {}
  /// The region is lost: what was carried from frame to frame means nothing any more.
  virtual void forget() {}
};

}  // namespace heartservo::tracking
