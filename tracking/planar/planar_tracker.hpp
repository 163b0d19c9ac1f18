#pragma once
// Around any aligner: image-space prediction, start values from several guesses, the states OK / UNCERTAIN / LOST, and
// re-acquisition by a search over the whole picture.
#include <Eigen/Core>
#include <memory>

#include "tracking/camera/camera.hpp"
#include "tracking/planar/composite_options.hpp"
#include "tracking/planar/patch_aligner.hpp"
#include "tracking/planar/target_tracker.hpp"
#include "tracking/settings/fields.hpp"

namespace heartservo::tracking {

struct TrackerOptions {
  int levels = 3;                   ///< pyramid levels at most; small regions use fewer
  int max_iterations = 15;          ///< per level
  double ok_quality = 0.8;          ///< at least this: OK
  double reacquire_quality = 0.87;  ///< needed to be found again after LOST
  double uncertain_quality = 0.6;   ///< at least this: UNCERTAIN; below: LOST
  double corner_sigma_px = 0.05;    ///< standard deviation of a tracked corner, for the covariance of the pose
  double search_px = 24;            ///< how far from the expected place to search before giving the region up
  CompositeOptions composite;

  void fields(FieldVisitor& v) {
    v.field({"levels", "", "pyramid levels at most; small regions use fewer", 1, 6}, levels);
    v.field({"max_iterations", "", "iterations of the alignment per pyramid level", 1, 100}, max_iterations);
    v.field({"ok_quality", "", "quality from which a track is OK", 0, 1}, ok_quality);
    v.field({"reacquire_quality", "", "quality needed to be found again after LOST", 0, 1}, reacquire_quality);
    v.field({"uncertain_quality", "", "quality below which a track is LOST", 0, 1}, uncertain_quality);
    v.field({"corner_sigma_px", "px", "standard deviation of a tracked corner: how far predictors trust positions",
             1e-4, 10},
            corner_sigma_px);
    v.field({"search_px", "px", "how far around the expected place to search before giving the region up", 0, 500},
            search_px);
    v.group("composite", "of the tracker `composite`: how candidates are compared by squared differences and texture",
            composite);
  }
};

class PlanarTracker final : public TargetTracker {
 public:
  /// With a calibrated camera the homography lives on the undistorted plane, where it is exact; `camera` without
  /// focal length means: no calibration, straight on the pixels.
  PlanarTracker(std::unique_ptr<PatchAligner> aligner, const Camera& camera, const TrackerOptions& options);

  std::string start(const Frame& frame, const Quad& corners) override;
  Track track(const Frame& frame) override;
  Eigen::Vector2d carry(const Eigen::Vector2d& start_px) const override;
  void mark_left_out(cv::Mat& mask) override;

 private:
  struct Candidate {
    Alignment alignment;
    double quality = 0;
  };

  struct SearchExtent {
    double radius_px;
    int places;            // of each view, best first
    std::size_t starts;    // of all views together, tried by aligning
    double turn_rad;       // of a further view; 0: none
    std::size_t turn = 0;  // counts calls: the last start is another one of the rest each time
    double scale = 1;      ///< another size of the last view to look for; 1: none
  };

  double glare_grey() const;
  std::string unfit_texture() const;
  Eigen::Vector2d pixel_of(const Eigen::Matrix3d& G_plane_patch, const Eigen::Vector2d& patch_point) const;
  Quad corners_of(const Eigen::Matrix3d& G_plane_patch) const;
  Eigen::Matrix3d shifted(const Eigen::Matrix3d& G_plane_patch, const Eigen::Vector2d& plane_shift) const;
  double quality_of(const Alignment& alignment, const Quad& expected) const;
  Candidate try_from(const Alignment& start, int coarsest, const Quad& expected);
  double found_again_quality() const;
  Candidate follow(const Frame& frame);
  Candidate search(const Quad& around, const SearchExtent& extent);
  Candidate reacquire(const cv::Mat& grey);
  void build_pyramid(const cv::Mat& grey, const Quad& a, const Quad& b, double margin_px, int levels);
  void believe(const Candidate& candidate, double time_s);

  std::unique_ptr<PatchAligner> aligner_;
  Camera camera_;
  TrackerOptions options_;
  ImagePyramid pyramid_;
  Quad patch_corners_{};      // in patch coordinates
  Quad reference_corners_{};  // px
  Alignment reference_;       // where the template was learnt
  Alignment last_;            // last believed
  double last_time_s_ = 0;
  Eigen::Vector2d plane_velocity_ = Eigen::Vector2d::Zero();  // of the centre, plane units per s
  double brightest_ = 255;                                    // of the template, grey
  double surprise_px_ = 0;    // how far the last frame's place was from the foreseen one
  double usual_quality_ = 1;  // of the last frames
  int lost_frames_ = 0;       // searched in vain since the last believed place
  bool started_ = false, locked_ = false;
  int width_ = 0, height_ = 0;
  double side_px_ = 0;
};

}  // namespace heartservo::tracking
