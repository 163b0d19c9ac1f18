#include "tracking/planar/planar_tracker.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

#include "tracking/frames/frame.hpp"
#include "tracking/planar/left_out.hpp"
#include "tracking/planar/noise_of.hpp"
#include "tracking/planar/sl3.hpp"
#include "tracking/planar/template_search.hpp"

namespace heartservo::tracking {

namespace {

constexpr double kSmallestSide = 12;        // px
constexpr double kSmallestGradient = 1.3;   // grey/px, RMS in the direction with the least texture
constexpr double kGlareMargin = 25;         // grey, above the brightest of the template
constexpr double kSmallSurprise = 1.2;      // px between foreseen and found place that one level copes with
constexpr double kSuddenFall = 0.06;        // of the quality, against the last frames
constexpr double kLeap = 0.2;               // of the side: mean distance of the corners from where they were foreseen
constexpr double kLikeBefore = 0.03;        // of the quality, between before a loss and after, with noise half again
constexpr double kLargestGrowth = 1.6;      // of the area, between two frames
constexpr double kLikelyShear = 1.3;        // anisotropy against the last frame
constexpr double kLargestScale = 2.5;       // of the side, against the reference
constexpr double kLikelyPerspective = 1.4;  // a 10 mm region 45 mm away, tilted by 60 degrees, has 1.21
constexpr double kLikelyAnisotropy = 2;     // tilted by 60 degrees

constexpr std::size_t kStartsWhileLost = 4;  // alignments from places found by correlation, in one frame
constexpr std::array<double, 4> kSearchTurns_rad{-0.26, 0.26, -0.52, 0.52};
constexpr double kSearchScale = 1.15;

Eigen::Matrix3d rotation(double angle_rad) {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  R(0, 0) = R(1, 1) = std::cos(angle_rad);
  R(1, 0) = std::sin(angle_rad);
  R(0, 1) = -R(1, 0);
  return R;
}

double mean_distance(const Quad& a, const Quad& b) {
  double sum = 0;
  for (std::size_t i = 0; i < 4; ++i) sum += (a[i] - b[i]).norm() / 4;
  return sum;
}

Eigen::Matrix3d intrinsics(const Camera& c) {
  Eigen::Matrix3d K;
  K << c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1;
  return K;
}

double brightest(const Patch& patch) {
  float b = 0;
  for (std::size_t i = 0; i < patch.size(); ++i)
    if (patch.usable[i] > 0) b = std::max(b, patch.grey[i]);
  return static_cast<double>(b);
}

}  // namespace

PlanarTracker::PlanarTracker(std::unique_ptr<PatchAligner> aligner, const Camera& camera, const TrackerOptions& options)
    : aligner_(std::move(aligner)), camera_(camera), options_(options) {
  if (!(camera_.fx > 0)) {
    camera_ = Camera{};
    camera_.fx = camera_.fy = 1;
  }
}

std::string PlanarTracker::start(const Frame& frame, const Quad& corners) {
  started_ = locked_ = false;
  if (frame.status != FrameStatus::OK) return "the first frame is not readable: " + frame.note;
  if (frame.grey.type() != CV_8UC1) return "the first frame is not 8-bit grey";
  if (!is_convex(corners)) return "the region's corners are not four finite points clockwise from top left";
  for (const auto& c : corners)
    if (c.x() < 0 || c.y() < 0 || c.x() > frame.grey.cols - 1 || c.y() > frame.grey.rows - 1)
      return fmt::format("the region's corner ({:.0f}, {:.0f}) lies outside the picture of {} x {} px", c.x(), c.y(),
                         frame.grey.cols, frame.grey.rows);
  const double side_x = 0.5 * ((corners[1] - corners[0]).norm() + (corners[2] - corners[3]).norm());
  const double side_y = 0.5 * ((corners[3] - corners[0]).norm() + (corners[2] - corners[1]).norm());
  if (std::min(side_x, side_y) < kSmallestSide)
    return fmt::format("the region of {:.0f} x {:.0f} px is smaller than {} px", side_x, side_y, kSmallestSide);

  width_ = frame.grey.cols;
  height_ = frame.grey.rows;
  side_px_ = std::max(side_x, side_y);
  reference_corners_ = corners;
  const double half_x = side_x / side_px_, half_y = side_y / side_px_;
  patch_corners_ = rectangle(-half_x, -half_y, 2 * half_x, 2 * half_y);
  Quad plane;
  for (std::size_t i = 0; i < 4; ++i) plane[i] = camera_.normalise(corners[i]);
  reference_ = Alignment{};
  reference_.G_plane_patch = to_sl3(homography_between(patch_corners_, plane));
  if (!reference_.G_plane_patch.allFinite()) return "the region's corners cannot be undistorted by this camera";
  build_pyramid(frame.grey, corners, corners, 16, options_.levels);
  aligner_->see(frame.grey);
  aligner_->learn(pyramid_, camera_, reference_.G_plane_patch, static_cast<int>(std::lround(side_x)),
                  static_cast<int>(std::lround(side_y)));
  if (std::string why = unfit_texture(); !why.empty()) return why;
  brightest_ = brightest(aligner_->patch(0));
  last_ = reference_;
  aligner_->believe(last_);
  last_time_s_ = frame.time_s;
  plane_velocity_.setZero();
  surprise_px_ = INFINITY;
  usual_quality_ = 1;
  lost_frames_ = 0;
  started_ = locked_ = true;
  return "";
}

double PlanarTracker::glare_grey() const {
  return started_ ? std::min<double>(kSaturatedGrey, (brightest_ - last_.bias) / last_.gain + kGlareMargin)
                  : kSaturatedGrey;
}

std::string PlanarTracker::unfit_texture() const {
  const Patch& patch = aligner_->patch(0);
  Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
  double n = 0;
  const std::size_t w = static_cast<std::size_t>(patch.width);
  for (std::size_t i = w; i + w < patch.size(); ++i) {  // unusable at the sides
    const float* g = &patch.grey[i];
    const Eigen::Vector2d gradient(0.5F * (g[1] - g[-1]), 0.5F * (g[w] - *(g - w)));
    sum += static_cast<double>(patch.usable[i]) * gradient * gradient.transpose();
    n += static_cast<double>(patch.usable[i]);
  }
  if (n < 0.3 * static_cast<double>(patch.size())) return "the region is mostly saturated or outside the picture";
  const double noise = noise_of(patch);  // has a gradient, too: half its variance, along both axes
  const Eigen::Vector2d eigenvalues =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(sum / n).eigenvalues().array() - noise * noise / 2;
  const double weakest = std::sqrt(std::max(0.0, eigenvalues[0]));
  if (weakest < kSmallestGradient)
    return fmt::format(
        "the region has too little texture: RMS gradient {:.2f} grey/px in its weakest direction beyond that of noise "
        "of {:.1f} grey, {} needed, condition number {:.0f}",
        weakest, noise, kSmallestGradient, std::max(eigenvalues[1], 0.0) / std::max(eigenvalues[0], 1e-12));
  return "";
}

Eigen::Vector2d PlanarTracker::pixel_of(const Eigen::Matrix3d& G, const Eigen::Vector2d& patch_point) const {
  return camera_.to_pixel(camera_.distort((G * patch_point.homogeneous()).hnormalized()));
}

Quad PlanarTracker::corners_of(const Eigen::Matrix3d& G) const {
  Quad corners;
  for (std::size_t i = 0; i < 4; ++i) corners[i] = pixel_of(G, patch_corners_[i]);
  return corners;
}

Eigen::Matrix3d PlanarTracker::shifted(const Eigen::Matrix3d& G, const Eigen::Vector2d& plane_shift) const {
  Eigen::Matrix3d move = Eigen::Matrix3d::Identity();
  move.topRightCorner<2, 1>() = plane_shift;
  return move * G;
}

// How well the alignment fits, lowered where it is no likely view of the same piece of tissue: a template that holds on
// to the wrong place fits best when it is bent out of shape.
double PlanarTracker::quality_of(const Alignment& a, const Quad& expected) const {
  if (!a.converged || !(a.correlation > 0)) return 0;
  const Quad corners = corners_of(a.G_plane_patch);
  if (!is_convex(corners)) return 0;
  const ViewChange view = view_change(reference_corners_, corners);
  const double growth = area(corners) / area(expected);
  if (growth > kLargestGrowth || growth < 1 / kLargestGrowth || view.scale > kLargestScale ||
      view.scale < 1 / kLargestScale)
    return 0;
  const Eigen::Vector2d c = centre(corners);
  if (c.x() < 0 || c.y() < 0 || c.x() > width_ - 1 || c.y() > height_ - 1) return 0;
  return a.fit() * std::min(1.0, kLikelyPerspective / view.perspective) *
         std::min(1.0, kLikelyAnisotropy / view.anisotropy) *
         std::min(1.0, kLikelyShear / view_change(expected, corners).anisotropy);
}

PlanarTracker::Candidate PlanarTracker::try_from(const Alignment& start, int coarsest, const Quad& expected) {
  Candidate c;
  c.alignment = aligner_->align(pyramid_, start, coarsest, MotionModel::HOMOGRAPHY);
  c.quality = quality_of(c.alignment, expected);
  if (c.quality >= options_.ok_quality || !aligner_->obeys_model()) return c;
  // Too little texture, or tissue that deforms, lets the perspective terms run away: fewer parameters hold.
  Candidate stiff;
  stiff.alignment = aligner_->align(pyramid_, start, coarsest, MotionModel::AFFINE);
  stiff.quality = quality_of(stiff.alignment, expected);
  return stiff.quality > c.quality ? stiff : c;
}

// What looks like the region somewhere else has to look as the region did: how much of the template fits elsewhere
// depends on the tissue, how well the template fits its own place on the noise.
double PlanarTracker::found_again_quality() const {
  return std::max(options_.reacquire_quality, usual_quality_ - kLikeBefore - 0.5 * (1 - usual_quality_));
}

PlanarTracker::Candidate PlanarTracker::follow(const Frame& frame) {
  const Quad last = corners_of(last_.G_plane_patch);
  Alignment predicted = last_;
  predicted.G_plane_patch = shifted(last_.G_plane_patch, plane_velocity_ * (frame.time_s - last_time_s_));
  const Quad expected = corners_of(predicted.G_plane_patch);
  // A motion that was foreseen well needs no coarse levels.
  const int needed = surprise_px_ < kSmallSurprise ? 1 : surprise_px_ < 3 * kSmallSurprise ? 2 : options_.levels;
  build_pyramid(frame.grey, last, expected, 0.35 * side_px_, std::min(needed, options_.levels));
  const double leap_px = std::isfinite(surprise_px_) ? kLeap * side_px_ : options_.search_px;
  Candidate best;
  const auto keep = [&](Candidate c) {
    if (c.quality < found_again_quality() && mean_distance(corners_of(c.alignment.G_plane_patch), expected) > leap_px)
      return;  // found, not followed
    if (c.quality > best.quality) best = c;
  };
  keep(try_from(predicted, needed - 1, last));
  // A sudden fall of the quality may be a wrong place that happens to look alike: look further before believing it.
  const double wanted = std::max(options_.ok_quality, usual_quality_ - kSuddenFall);
  if (best.quality < wanted) {
    build_pyramid(frame.grey, last, expected, 0.35 * side_px_, options_.levels);
    for (const Alignment* start : {&predicted, &last_}) keep(try_from(*start, options_.levels - 1, last));
  }
  if (best.quality < wanted) {
    build_pyramid(frame.grey, last, last, options_.search_px + 0.35 * side_px_, options_.levels);
    keep(search(last, {options_.search_px, 3, 6, 0}));
  }
  surprise_px_ =
      best.quality > 0 ? (centre(corners_of(best.alignment.G_plane_patch)) - centre(expected)).norm() : INFINITY;
  return best;
}

PlanarTracker::Candidate PlanarTracker::reacquire(const cv::Mat& grey) {
  pyramid_.build(grey, cv::Rect(0, 0, grey.cols, grey.rows), options_.levels, glare_grey());
  aligner_->forget();
  // A frame has time for a part of the search: upright in every one, nearer and further (by as much as a heart moves in
  // half a beat) and turned one way after the other; the most alike places in every one, the others in turn.
  const auto n = static_cast<std::size_t>(lost_frames_++);
  return search(corners_of(last_.G_plane_patch),
                {std::hypot(grey.cols, grey.rows), 6, kStartsWhileLost, kSearchTurns_rad[n % 4], n,
                 n % 2 == 0 ? kSearchScale : 1 / kSearchScale});
}

// Correlates the template, as the last believed alignment and the reference show it, with a coarse level of the pyramid
// and aligns from the best places. After a loss it may have turned or come nearer meanwhile.
PlanarTracker::Candidate PlanarTracker::search(const Quad& around, const SearchExtent& extent) {
  const int level = search_level(side_px_, pyramid_.levels());
  struct Start {
    Alignment alignment;
    Quad expected;
    double correlation = 0;
  };
  std::vector<Start> starts;
  const auto look_for = [&](const Alignment& view) {
    const Quad corners = corners_of(view.G_plane_patch);
    const auto places = find_template(aligner_->patch(level), corners, pyramid_.level(level), centre(around),
                                      extent.radius_px, extent.places);
    for (const auto& place : places) {
      const Eigen::Vector2d from = camera_.normalise(centre(corners)), to = camera_.normalise(place.centre);
      if (!from.allFinite() || !to.allFinite()) continue;
      Start start{view, corners, place.correlation};
      start.alignment.G_plane_patch = shifted(view.G_plane_patch, to - from);
      start.alignment.gain = last_.gain;
      start.alignment.bias = last_.bias;
      starts.push_back(start);
    }
  };
  look_for(last_);
  look_for(reference_);
  if (extent.scale != 1) {
    Alignment view = last_;
    view.G_plane_patch *= Eigen::Vector3d(extent.scale, extent.scale, 1).asDiagonal();
    look_for(view);
  }
  if (extent.turn_rad != 0) {
    Alignment view = reference_;
    view.G_plane_patch *= rotation(extent.turn_rad);
    look_for(view);
  }
  std::stable_sort(starts.begin(), starts.end(),
                   [](const Start& a, const Start& b) { return a.correlation > b.correlation; });
  if (starts.size() > extent.starts) {
    const std::size_t last = extent.starts - 1;
    std::swap(starts[last], starts[last + extent.turn % (starts.size() - last)]);
    starts.resize(extent.starts);
  }
  Candidate best;
  for (const Start& start : starts)
    if (const Candidate c = try_from(start.alignment, level, start.expected); c.quality > best.quality) {
      best = c;
      if (best.quality >= std::max(options_.ok_quality, usual_quality_ - kSuddenFall)) break;
    }
  return best;
}

void PlanarTracker::build_pyramid(const cv::Mat& grey, const Quad& a, const Quad& b, double margin_px, int levels) {
  double left = 1e9, top = 1e9, right = -1e9, bottom = -1e9;
  for (const Quad* quad : {&a, &b})
    for (const auto& c : *quad) {
      if (!c.allFinite()) continue;
      left = std::min(left, c.x()), right = std::max(right, c.x());
      top = std::min(top, c.y()), bottom = std::max(bottom, c.y());
    }
  // Four pixels of the coarsest level keep the smoothing of the pyramid away from the window's border.
  const double margin = margin_px + 4.0 * (1 << (levels - 1));
  const auto clip = [](double v) { return static_cast<int>(std::clamp(v, -1e6, 1e6)); };
  const cv::Point from(clip(left - margin), clip(top - margin)),
      to(clip(right + margin + 1), clip(bottom + margin + 1));
  pyramid_.build(grey, cv::Rect(from, to), levels, glare_grey());
}

void PlanarTracker::believe(const Candidate& candidate, double time_s) {
  const auto centre_of = [&](const Alignment& a) {
    return Eigen::Vector2d((a.G_plane_patch * Eigen::Vector3d::UnitZ()).hnormalized());
  };
  const double dt = time_s - last_time_s_;
  if (locked_ && dt > 0) {
    plane_velocity_ = (centre_of(candidate.alignment) - centre_of(last_)) / dt;
  } else {
    plane_velocity_.setZero();
    surprise_px_ = INFINITY;  // nothing is foreseen yet
  }
  last_ = candidate.alignment;
  aligner_->believe(last_);
  last_time_s_ = time_s;
  lost_frames_ = 0;
  locked_ = true;
}

Track PlanarTracker::track(const Frame& frame) {
  Track track;
  track.time_s = frame.time_s;
  track.sequence = frame.sequence;
  if (!started_) return track;
  const bool readable = frame.status == FrameStatus::OK && frame.grey.type() == CV_8UC1 && frame.grey.cols == width_ &&
                        frame.grey.rows == height_;
  if (readable) {
    aligner_->see(frame.grey);
    const bool was_locked = locked_;
    // What is not near its place is looked for in the whole picture from the next frame on: this one's time is spent.
    Candidate found = locked_ ? follow(frame) : reacquire(frame.grey);
    if (!(found.quality >= (locked_ ? options_.uncertain_quality : found_again_quality()))) {
      found.quality = 0;
      locked_ = false;
    }
    if (found.quality >= options_.uncertain_quality) {
      track.reacquired = !was_locked;
      believe(found, frame.time_s);
      const double wanted = std::max(options_.ok_quality, usual_quality_ - 2 * kSuddenFall);
      track.state = found.quality >= wanted ? TrackState::OK : TrackState::UNCERTAIN;
      usual_quality_ += (track.state == TrackState::OK ? 0.2 : 0.05) * (found.quality - usual_quality_);
      track.quality = std::min(1.0, found.quality);
      track.iterations = found.alignment.iterations;
      track.noise_grey = found.alignment.noise_grey;
    }
  }
  const Eigen::Matrix3d K = intrinsics(camera_);
  track.corners = corners_of(last_.G_plane_patch);
  track.target = pixel_of(last_.G_plane_patch, aligner_->bent(last_, Eigen::Vector2d::Zero()));
  for (int i = 0; i < kGridSide * kGridSide; ++i) {
    const auto along = [](int k) { return (2 * k + 1.0) / kGridSide - 1; };
    const Eigen::Vector2d point(along(i % kGridSide) * patch_corners_[2].x(),
                                along(i / kGridSide) * patch_corners_[2].y());
    track.points[static_cast<std::size_t>(i)] = pixel_of(last_.G_plane_patch, aligner_->bent(last_, point));
  }
  track.gain = last_.gain;
  track.bias = last_.bias;
  track.H_current_reference = to_sl3(K * last_.G_plane_patch * reference_.G_plane_patch.inverse() * K.inverse());
  return track;
}

Eigen::Vector2d PlanarTracker::carry(const Eigen::Vector2d& start_px) const {
  if (!started_) return Eigen::Vector2d::Constant(NAN);
  const Eigen::Vector2d plane = camera_.normalise(start_px);
  const Eigen::Vector2d patch_point = (reference_.G_plane_patch.inverse() * plane.homogeneous()).hnormalized();
  return pixel_of(last_.G_plane_patch, aligner_->bent(last_, patch_point));
}

void PlanarTracker::mark_left_out(cv::Mat& mask) {
  if (mask.empty()) mask = cv::Mat::zeros(height_, width_, CV_8UC1);
  if (!started_ || !locked_ || mask.cols != width_ || mask.rows != height_) return;
  tracking::mark_left_out(pyramid_.level(0), camera_, *aligner_, last_, mask);
}

}  // namespace heartservo::tracking
