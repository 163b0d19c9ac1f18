#pragma once
// Candidate regions of interest around a predicted place, compared with the template by squared grey differences and
// texture (Sauvee et al., section 3.2, eq. 10 to 14), coarse to fine:
//
//   1. every place of the window, on a coarse pyramid level, by squared differences; the `places` most alike that are
//      not neighbours stay,
//   2. each of them turned and scaled a little either way,
//   3. the best of these with its neighbours on a finer level (kReach to every side) are the ROIs of eq. (10) to (12).
//
// Glare and what was hidden in the last frame are left out of both measures. Nothing is allocated once the largest
// window has been searched.
#include <cstdint>
#include <vector>

#include "tracking/planar/candidate_score.hpp"
#include "tracking/planar/composite_options.hpp"
#include "tracking/planar/roi_texture.hpp"
#include "tracking/planar/upright_view.hpp"

namespace heartservo::tracking {

/// One place, by its best ROI.
struct Candidate {
  Eigen::Matrix3d G_plane_patch = Eigen::Matrix3d::Identity();
  Light light;
  Roi roi;
  bool at_start = false;  ///< not turned, and no further from the start than the finer level can tell
};

/// Points of the template at texture_level() that something lay over in the last frame; empty: none.
using HiddenPoints = std::vector<std::uint8_t>;

class CandidateSearch {
 public:
  explicit CandidateSearch(const CompositeOptions& options);

  /// As PatchAligner::learn.
  void learn(const SearchPicture& picture, const Camera& camera, const Eigen::Matrix3d& G_plane_patch, int side_x,
             int side_y);

  /// Candidates within about `radius_px` (px of the picture in which the template was learnt), best first; as many as
  /// places. `hidden` is understood at the start.
  const std::vector<Candidate>& around(const SearchPicture& picture, const Eigen::Matrix3d& G_start, double radius_px,
                                       const HiddenPoints& hidden);

  /// Levels of the pyramid that around() needs.
  static constexpr int kLevels = 3;
  static constexpr int kReach = 2;  ///< neighbours of a place on the finer level, to every side
  /// Where texture is compared.
  int texture_level() const { return fine_.level; }
  const Patch& texture_patch() const { return fine_.patch; }
  /// All ROIs of the last search: of each place (2 kReach + 1)^2, row by row.
  const std::vector<Roi>& rois() const { return rois_; }

 private:
  /// The template at one scale.
  struct Scale {
    int level = 0;
    Patch patch;
    WindowTemplate window;
    double px_per_point = 1;
  };
  /// A place in step 1 and 2.
  struct Place {
    Eigen::Matrix3d M_start_patch;  ///< patch coordinates of the start from those of the candidate
    double d = 1;
    bool turned = false;
  };

  Scale scale_at(const SearchPicture& picture, int level, const Eigen::Matrix3d& G, int side_x, int side_y) const;
  void find_places(const SearchPicture& picture, const Eigen::Matrix3d& G_start, double radius_px);
  void turn(const SearchPicture& picture, const Eigen::Matrix3d& G_start, Place& place);
  void compare(const SearchPicture& picture, const Eigen::Matrix3d& G_start);
  void look_at(const SearchPicture& picture, const Scale& scale, const Eigen::Matrix3d& G_start,
               const Eigen::Matrix3d& M_start_patch, Interpolation interpolation, int margin, UprightView& view) const;
  void hide(const Eigen::Matrix3d& M_start_patch, UprightView& view) const;

  CompositeOptions options_;
  CandidateScore score_;
  Camera camera_;
  Scale coarse_, fine_;
  RoiTexture texture_;
  std::vector<Eigen::Matrix3d> turns_;  // rotations and scales other than none
  const HiddenPoints* hidden_ = nullptr;

  UprightView coarse_view_;
  std::vector<UprightView> fine_views_;  // of each place
  std::vector<double> d_map_;
  std::vector<Place> places_;
  std::vector<Roi> rois_;
  std::vector<Light> lights_;  // of each ROI
  std::vector<Candidate> candidates_;
};

}  // namespace heartservo::tracking
