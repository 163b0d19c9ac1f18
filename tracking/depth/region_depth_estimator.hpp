#pragma once
#include <optional>

#include "tracking/camera/camera.hpp"
#include "tracking/depth/deformation_prior.hpp"
#include "tracking/depth/depth_options.hpp"
#include "tracking/depth/scale_source.hpp"
#include "tracking/depth/surface_model.hpp"
#include "tracking/frames/frame.hpp"
#include "tracking/landmark/target_estimator.hpp"

namespace heartservo::tracking {

/// Metric position of a texture region whose distance was known once, from where the tracker sees its points
/// (Track::points; docs/depth.md). Target frame: origin at the region's centre; axes those of the camera in the first
/// frame, turned since with the region.
///
/// Maximum a posteriori over position, rotation, the surface's shape and its deformation, by Gauss-Newton. What the
/// picture cannot tell from stretching (depth, above all) comes out uncertain. The shape is carried from frame to frame.
class RegionDepthEstimator final : public TargetEstimator {
 public:
  /// `point_sigma_px`: of a tracked point. Throws ConfigError with every problem of the options or the sigma.
  RegionDepthEstimator(const Camera& camera, ScaleSource scale, const DepthOptions& options, double point_sigma_px);

  void look_at(const Frame& frame) override { frame_ = frame; }

  /// LOST until a frame in which the region is followed and the scale is known: that becomes the first one.
  TargetState estimate(const Track& track) override;

  /// What the scale was fixed by; a depth of 0 while it is not.
  const ScaleReference& scale() const { return scale_; }

  /// Slopes, and curvatures times scale().depth_m, as known by now.
  const SurfaceShape& shape() const { return shape_; }

 private:
  using Vector11 = Eigen::Matrix<double, 11, 1>;
  using Matrix11 = Eigen::Matrix<double, 11, 11>;

  bool begin(const Track& track);
  bool solve(SurfacePose& pose, SurfaceShape& shape, Matrix11& covariance);
  void report(const Track& track, const SurfacePose& pose, const SurfaceShape& shape, const Matrix11& covariance,
              TargetState& state);
  void learn_shape(double time_s, const SurfaceShape& shape, const Matrix11& covariance);

  Camera camera_;
  ScaleSource source_;
  DepthOptions options_;
  double point_sigma_px_, noise_ = 0;
  ScaleReference scale_;
  Frame frame_;
  std::optional<SurfaceModel> model_;
  DeformationPrior prior_;
  SurfacePose last_;
  double last_time_s_ = 0;
  SurfaceShape shape_ = SurfaceShape::Zero();
  Eigen::Matrix<double, 5, 5> shape_covariance_;
  Eigen::VectorXd seen_, expected_, residual_;  // normalised points of the frame, of the model; their difference
  Eigen::MatrixXd J_pose_, J_shape_, J_, WJ_;
};

}  // namespace heartservo::tracking
