#include "tracking/planar/candidate_search.hpp"

#include <algorithm>
#include <cmath>

namespace heartservo::tracking {

namespace {

constexpr int kCoarsePoints = 16;   // along the longer side, at least: fewer look alike too often
constexpr int kTexturePoints = 48;  // at most: texture of more says little more and takes longer
constexpr int kApart = 3;           // coarse points between two places
constexpr int kTurnReach = 1;       // coarse points around a place where its turned views are compared
constexpr int kSide = 2 * CandidateSearch::kReach + 1;

int level_for(int side_px, bool (*fits)(int points)) {
  int level = 0;
  while (level + 1 < CandidateSearch::kLevels && fits(side_px >> (level + 1))) ++level;
  return level;
}

Eigen::Matrix3d shift(double x, double y) {
  Eigen::Matrix3d T = Eigen::Matrix3d::Identity();
  T(0, 2) = x;
  T(1, 2) = y;
  return T;
}

Eigen::Matrix3d turn_of(double angle_rad, double scale) {
  Eigen::Matrix3d M = Eigen::Matrix3d::Identity();
  M(0, 0) = M(1, 1) = scale * std::cos(angle_rad);
  M(1, 0) = scale * std::sin(angle_rad);
  M(0, 1) = -M(1, 0);
  return M;
}

}  // namespace

CandidateSearch::CandidateSearch(const CompositeOptions& options)
    : options_(options), score_(weighting_of(options.weighting), options.texture_weight) {
  for (const int r : {0, -1, 1})
    for (const int s : {0, -1, 1})
      if (r != 0 || s != 0) turns_.push_back(turn_of(r * options.rotation_deg * M_PI / 180, 1 + s * options.scale));
}

CandidateSearch::Scale CandidateSearch::scale_at(const SearchPicture& picture, int level, const Eigen::Matrix3d& G,
                                                 int side_x, int side_y) const {
  Scale scale;
  scale.level = level;
  scale.patch = make_patch(picture.pyramid().level(level), camera_, G, (side_x >> level) + 1, (side_y >> level) + 1);
  scale.window = WindowTemplate(scale.patch);
  scale.px_per_point =
      std::max(side_x, side_y) / static_cast<double>(std::max(scale.patch.width, scale.patch.height) - 1);
  return scale;
}

void CandidateSearch::learn(const SearchPicture& picture, const Camera& camera, const Eigen::Matrix3d& G, int side_x,
                            int side_y) {
  camera_ = camera;
  const int longer = std::max(side_x, side_y), available = picture.pyramid().levels() - 1;
  const int coarse = level_for(longer, [](int points) { return points >= kCoarsePoints; });
  int fine = 0;
  while (fine < coarse && (longer >> fine) > kTexturePoints) ++fine;
  coarse_ = scale_at(picture, std::min(coarse, available), G, side_x, side_y);
  fine_ = scale_at(picture, std::min(fine, available), G, side_x, side_y);
  hidden_ = nullptr;
  UprightView view;
  look_at(picture, fine_, G, Eigen::Matrix3d::Identity(), Interpolation::CUBIC, 0, view);
  texture_ = RoiTexture(options_.grey_levels, view, fine_.window.mean);
  const auto places = static_cast<std::size_t>(options_.places);
  fine_views_.resize(places);
  places_.reserve(places);
  candidates_.reserve(places);
  rois_.reserve(places * kSide * kSide);
  lights_.reserve(places * kSide * kSide);
}

const std::vector<Candidate>& CandidateSearch::around(const SearchPicture& picture, const Eigen::Matrix3d& G_start,
                                                      double radius_px, const HiddenPoints& hidden) {
  hidden_ = hidden.size() == fine_.patch.size() ? &hidden : nullptr;
  find_places(picture, G_start, radius_px);
  for (Place& place : places_) turn(picture, G_start, place);
  compare(picture, G_start);
  return candidates_;
}

void CandidateSearch::look_at(const SearchPicture& picture, const Scale& scale, const Eigen::Matrix3d& G_start,
                              const Eigen::Matrix3d& M_start_patch, Interpolation interpolation, int margin,
                              UprightView& view) const {
  view.shape(scale.patch, margin);
  look(picture, scale.level, camera_, G_start * M_start_patch, interpolation, scale.window.mean, view);
  if (hidden_) hide(M_start_patch, view);
}

// What hid the template's points in the last frame is thought to lie where it lay, seen from the start.
void CandidateSearch::hide(const Eigen::Matrix3d& M, UprightView& view) const {
  const double points = 1 / static_cast<double>(fine_.patch.step);
  const Eigen::Matrix<double, 2, 3> A = M.topRows<2>() * points;
  const double u0 = 0.5 * fine_.patch.width, v0 = 0.5 * fine_.patch.height;
  std::size_t i = 0;
  for (int row = 0; row < view.grid.height; ++row)
    for (int column = 0; column < view.grid.width; ++column, ++i) {
      const Eigen::Vector2d at = A * Eigen::Vector3d(view.grid.x_of(column), view.grid.y_of(row), 1);
      const double u = std::floor(at.x() + u0), v = std::floor(at.y() + v0);
      if (!(u >= 0 && v >= 0 && u < fine_.patch.width && v < fine_.patch.height)) continue;
      if ((*hidden_)[static_cast<std::size_t>(v * fine_.patch.width + u)]) view.grey[i] = view.clear[i] = 0;
    }
}

void CandidateSearch::find_places(const SearchPicture& picture, const Eigen::Matrix3d& G_start, double radius_px) {
  const int reach = std::max(1, static_cast<int>(std::ceil(radius_px / coarse_.px_per_point))), side = 2 * reach + 1;
  look_at(picture, coarse_, G_start, Eigen::Matrix3d::Identity(), Interpolation::LINEAR, reach, coarse_view_);
  d_map_.resize(static_cast<std::size_t>(side * side));
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      d_map_[static_cast<std::size_t>(y * side + x)] = fit_of(coarse_.window, coarse_view_, x, y).d;
  places_.clear();
  for (int k = 0; k < options_.places; ++k) {
    const auto best = std::min_element(d_map_.begin(), d_map_.end());
    if (*best >= 1) break;
    const int at = static_cast<int>(best - d_map_.begin()), x = at % side, y = at / side;
    const double step = static_cast<double>(coarse_.patch.step);
    places_.push_back({shift((x - reach) * step, (y - reach) * step), *best, false});
    for (int v = std::max(0, y - kApart); v <= std::min(side - 1, y + kApart); ++v)
      for (int u = std::max(0, x - kApart); u <= std::min(side - 1, x + kApart); ++u)
        d_map_[static_cast<std::size_t>(v * side + u)] = 1;
  }
}

void CandidateSearch::turn(const SearchPicture& picture, const Eigen::Matrix3d& G_start, Place& place) {
  const Eigen::Matrix3d M_start_place = place.M_start_patch;
  const double step = static_cast<double>(coarse_.patch.step);
  for (const Eigen::Matrix3d& M_turn : turns_) {
    const Eigen::Matrix3d M = M_start_place * M_turn;
    look_at(picture, coarse_, G_start, M, Interpolation::LINEAR, kTurnReach, coarse_view_);
    for (int y = 0; y <= 2 * kTurnReach; ++y)
      for (int x = 0; x <= 2 * kTurnReach; ++x) {
        const double d = fit_of(coarse_.window, coarse_view_, x, y).d;
        if (d < place.d) place = {M * shift((x - kTurnReach) * step, (y - kTurnReach) * step), d, true};
      }
  }
}

void CandidateSearch::compare(const SearchPicture& picture, const Eigen::Matrix3d& G_start) {
  rois_.clear();
  lights_.clear();
  for (std::size_t k = 0; k < places_.size(); ++k) {
    look_at(picture, fine_, G_start, places_[k].M_start_patch, Interpolation::CUBIC, kReach, fine_views_[k]);
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        const WindowFit fit = fit_of(fine_.window, fine_views_[k], x, y);
        rois_.push_back({fit.d});
        lights_.push_back(fit.light);
      }
  }
  candidates_.clear();
  if (rois_.empty()) return;
  score_.choose(rois_);
  // One light for all: texture is to tell a flat place from a rich one.
  const auto most_alike =
      std::min_element(rois_.begin(), rois_.end(), [](const Roi& a, const Roi& b) { return a.d < b.d; });
  const Light light = lights_[static_cast<std::size_t>(most_alike - rois_.begin())];
  for (std::size_t k = 0; k < places_.size(); ++k) {
    Roi* const rois = rois_.data() + k * kSide * kSide;
    if (std::none_of(rois, rois + kSide * kSide, [](const Roi& roi) { return roi.compared; })) continue;
    texture_.load(fine_views_[k], light);
    for (int y = 0; y < kSide; ++y)
      for (int i = 0; i < kSide; ++i) {
        const int x = y % 2 == 0 ? i : kSide - 1 - i;  // to and fro: each window next to the one before
        Roi& roi = rois[y * kSide + x];
        if (roi.compared) roi.t = texture_.distance(x, y);
      }
  }
  score_.score(rois_);

  const double step = static_cast<double>(fine_.patch.step);
  for (std::size_t k = 0; k < places_.size(); ++k) {
    const auto first = rois_.begin() + static_cast<std::ptrdiff_t>(k * kSide * kSide);
    const auto best =
        std::min_element(first, first + kSide * kSide, [](const Roi& a, const Roi& b) { return a.s < b.s; });
    const int at = static_cast<int>(best - first);
    const Eigen::Matrix3d M =
        places_[k].M_start_patch * shift((at % kSide - kReach) * step, (at / kSide - kReach) * step);
    candidates_.push_back({G_start * M, lights_[static_cast<std::size_t>(best - rois_.begin())], *best,
                           !places_[k].turned && M.topRightCorner<2, 1>().norm() < 1.5 * step});
  }
  std::sort(candidates_.begin(), candidates_.end(),
            [](const Candidate& a, const Candidate& b) { return a.roi.s < b.roi.s; });
}

}  // namespace heartservo::tracking
