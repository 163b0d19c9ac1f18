#include "tracking/camera/calibration/calibration.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tracking/camera/calibration/calibration_start.hpp"
#include "tracking/camera/calibration/disc_offset.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tracking {

namespace {

constexpr std::size_t FEWEST_VIEWS = 3;
constexpr std::size_t FEWEST_VIEWS_FREE = 6;  // pictures, to tell the board's shape from the lens
constexpr double BEST_CORNER_PX = 0.02;       // no detector is better; below, residuals say nothing about certainty
constexpr double GROSS = 6;                   // standard deviations; chance gives it to one corner in 10^7
constexpr double TORN = 5;                    // times worse together than alone: no pair
constexpr double VAGUE = 0.05;                // of a focal length, or of the picture: not determined

std::size_t views_of(const std::vector<BoardPosition>& positions, std::size_t side) {
  return static_cast<std::size_t>(std::count_if(positions.begin(), positions.end(),
                                                [&](const BoardPosition& p) { return !p.corners[side].empty(); }));
}

const char* side_name(std::size_t sides, std::size_t side) {
  return sides == 1 ? "" : side == 0 ? "left: " : "right: ";
}

// A disc's picture has its centre of gravity elsewhere than the picture of its centre: what was measured, less that.
// Corners left out of `used` stay so.
std::vector<BoardPosition> without_disc_offsets(const std::vector<BoardPosition>& measured,
                                                const std::vector<BoardPosition>& used, const BoardRig& rig,
                                                double diameter_m) {
  auto result = used;
  for (std::size_t p = 0; p < result.size(); ++p)
    for (std::size_t side = 0; side < rig.cameras.size(); ++side) {
      const Eigen::Isometry3d T =
          side == 0 ? rig.T_left_board[p] : Eigen::Isometry3d(rig.T_right_left * rig.T_left_board[p]);
      for (std::size_t i = 0; i < result[p].corners[side].size(); ++i)
        if (used[p].corners[side][i].allFinite())
          result[p].corners[side][i] =
              measured[p].corners[side][i] - disc_offset(rig.cameras[side], T, rig.points[i], diameter_m);
    }
  return result;
}

class Calibrator {
 public:
  Calibrator(const Board& board, int width, int height, std::size_t sides, const std::vector<BoardPosition>& positions)
      : board_(board), width_(width), height_(height), sides_(sides), measured_(positions), positions_(positions) {}

  void fit_flat() {
    best_ = calibrate_one_camera(board_, width_, height_, positions_, 0);
    if (sides_ == 2) {
      const auto left = best_, right = calibrate_one_camera(board_, width_, height_, positions_, 1);
      best_ = calibrate_two_cameras(board_, left, right, positions_);
      const double alone = left.sum_of_squares_px2 + right.sum_of_squares_px2;
      if (alone > 1e-12) pair_strain_ = std::sqrt(best_.sum_of_squares_px2 / alone);
      if (pair_strain_ > TORN)
        throw InputError(
            fmt::format("left and right views fit {:.0f} times worse together than alone; give both sides in the same "
                        "order, and take the pictures of a pair at the same time",
                        pair_strain_));
    }
    correct_discs({});
    drop_gross_errors({});
  }

  // Returns the F ratio of the free board against the flat one.
  double fit_free() {
    const BoardAdjustment flat = best_;
    const FreeParts free{true, true};
    best_ = adjust_board_rig(flat.rig, positions_, free);
    for (int round = 0; round < 4 && renumber(); ++round) best_ = adjust_board_rig(best_.rig, positions_, free);
    correct_discs(free);
    const int extra = flat.degrees_of_freedom - best_.degrees_of_freedom;
    return (flat.sum_of_squares_px2 - best_.sum_of_squares_px2) / extra /
           (best_.sum_of_squares_px2 / best_.degrees_of_freedom);
  }

  // Corners that a detector put elsewhere, or that a list has wrong: they are left out one view at a time, as long as
  // there are any.
  void drop_gross_errors(const FreeParts& free) {
    for (int round = 0; round < 5; ++round) {
      bool dropped = false;
      for (std::size_t p = 0; p < positions_.size(); ++p)
        for (std::size_t side = 0; side < sides_; ++side) dropped |= drop_from(p, side);
      if (!dropped) return;
      best_ = adjust_board_rig(best_.rig, positions_, free);
    }
  }

  const BoardAdjustment& best() const { return best_; }
  const std::vector<BoardPosition>& positions() const { return positions_; }  // what is left out is not finite
  const std::vector<BoardPosition>& measured() const { return measured_; }

  double pair_strain() const { return pair_strain_; }

  // A corner's standard deviation, as the residuals show it.
  double sigma_px() const {
    return best_.degrees_of_freedom > 0 ? std::sqrt(best_.sum_of_squares_px2 / best_.degrees_of_freedom) : 0;
  }

 private:
  bool drop_from(std::size_t p, std::size_t side) {
    const Corners residuals = board_residuals(best_.rig, positions_, p, side);
    std::vector<double> sizes;
    for (const auto& r : residuals)
      if (r.allFinite()) sizes.push_back(r.norm());
    if (sizes.empty()) return false;
    const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
    std::nth_element(sizes.begin(), middle, sizes.end());
    // the median length of a round Gaussian is 1.177 sigma
    const double sigma = std::max({*middle / 1.177, robust_sigma(), BEST_CORNER_PX});
    bool dropped = false;
    for (std::size_t i = 0; i < residuals.size(); ++i) {
      if (!(residuals[i].norm() > GROSS * sigma)) continue;
      positions_[p].corners[side][i].setConstant(std::numeric_limits<double>::quiet_NaN());
      dropped = true;
    }
    return dropped;
  }

  // A corner's standard deviation from the median residual, which gross errors do not move.
  double robust_sigma() const {
    std::vector<double> sizes;
    for (std::size_t p = 0; p < positions_.size(); ++p)
      for (std::size_t side = 0; side < sides_; ++side)
        for (const auto& r : board_residuals(best_.rig, positions_, p, side))
          if (r.allFinite()) sizes.push_back(r.norm());
    const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
    std::nth_element(sizes.begin(), middle, sizes.end());
    return *middle / 1.177;
  }

  void correct_discs(const FreeParts& free) {
    for (int round = 0; board_.disc_m > 0 && round < 3; ++round) {
      positions_ = without_disc_offsets(measured_, positions_, best_.rig, board_.disc_m);
      best_ = adjust_board_rig(best_.rig, positions_, free);
    }
  }

  // A detector numbers a board from either end: views that fit the shape found better the other way round are turned.
  // True if any was.
  bool renumber() {
    const auto orders = same_looking_orders(board_);
    bool changed = false;
    for (std::size_t p = 0; p < positions_.size(); ++p) {
      double least = 0;
      std::size_t best_order = 0;
      Eigen::Isometry3d best_pose = Eigen::Isometry3d::Identity();
      for (std::size_t k = 0; k < orders.size(); ++k) {
        const auto [cost, pose] = cost_of(p, orders[k], orders[0], board_.points());
        if (k > 0 && !(cost < 0.98 * least)) continue;
        least = cost;
        best_order = k;
        best_pose = pose;
      }
      if (best_order == 0) continue;
      changed = true;
      best_.rig.T_left_board[p] = best_pose;
      for (auto* positions : {&positions_, &measured_})
        for (auto& corners : (*positions)[p].corners)
          if (!corners.empty()) corners = reordered(corners, orders[best_order]);
    }
    return changed;
  }

  // Sum of squares of position p with its points in another order and its pose fitted to that, and the pose.
  std::pair<double, Eigen::Isometry3d> cost_of(std::size_t p, const std::vector<std::size_t>& order,
                                               const std::vector<std::size_t>& identity,
                                               const std::vector<Eigen::Vector3d>& nominal) const {
    BoardRig rig = best_.rig;
    BoardPosition position = positions_[p];
    for (auto& corners : position.corners)
      if (!corners.empty()) corners = reordered(corners, order);
    if (order != identity) {
      // the new point i is where the old point order[i] was: the board turned in its plane
      const Eigen::Vector3d x = (nominal[order[1]] - nominal[order[0]]).normalized();
      Eigen::Isometry3d turn = Eigen::Isometry3d::Identity();
      turn.linear() << x.x(), -x.y(), 0, x.y(), x.x(), 0, 0, 0, 1;
      rig.T_left_board[p] = rig.T_left_board[p] * turn;
    }
    rig.T_left_board = {rig.T_left_board[p]};
    const auto adjusted = adjust_board_rig(rig, {position}, {false, false});
    return {adjusted.sum_of_squares_px2, adjusted.rig.T_left_board[0]};
  }

  const Board& board_;
  int width_, height_;
  std::size_t sides_;
  std::vector<BoardPosition> measured_, positions_;
  BoardAdjustment best_;
  double pair_strain_ = 1;
};

// Evidence that chance gives less than once in a billion runs.
bool is_beyond_chance(double F, int extra, int degrees_of_freedom) {
  return F > 1 + 6 * std::sqrt(2.0 / extra + 2.0 / degrees_of_freedom);
}

// The parameters that are not determined, as text; a corner's standard deviation is taken to be at least what detectors
// reach.
std::vector<std::string> vague_parameters(const BoardAdjustment& a, std::size_t side, double sigma_px) {
  const Camera& camera = a.rig.cameras[side];
  const CameraParameters values = parameters_of(camera);
  const double scales[4] = {std::abs(camera.fx), std::abs(camera.fy), double(camera.width), double(camera.height)};
  std::vector<std::string> result;
  for (int k = 0; k < 4; ++k) {
    const auto at = 8 * static_cast<int>(side) + k;
    const double deviation = std::max(sigma_px, BEST_CORNER_PX) * std::sqrt(a.inverse_information(at, at));
    if (!(deviation < VAGUE * scales[k]))
      result.push_back(deviation < 1e6
                           ? fmt::format("{} ({:.0f} ± {:.0f} px)", CAMERA_PARAMETER_NAMES[k], values[k], deviation)
                           : CAMERA_PARAMETER_NAMES[k]);
  }
  return result;
}

bool is_determined(const Calibrator& calibrator, std::size_t sides) {
  for (std::size_t side = 0; side < sides; ++side)
    if (!vague_parameters(calibrator.best(), side, calibrator.sigma_px()).empty()) return false;
  return true;
}

void require_determined(const Calibrator& calibrator, std::size_t sides) {
  const BoardAdjustment& a = calibrator.best();
  for (std::size_t side = 0; side < sides; ++side) {
    const auto vague = vague_parameters(a, side, calibrator.sigma_px());
    if (!vague.empty())
      throw InputError(fmt::format(
          "{}the views do not determine {}; are all boards parallel, or too alike? Take views with the board tilted by "
          "20 to 45 degrees to several sides",
          side_name(sides, side), fmt::join(vague, ", ")));
    const auto problems = a.rig.cameras[side].validate();
    if (!problems.empty())
      throw InputError(
          fmt::format("{}the views do not make a usable camera: {}; show the board up to the rim of the picture, too",
                      side_name(sides, side), fmt::join(problems, "; ")));
  }
}

CalibratedView view_of(const Calibrator& calibrator, std::size_t p, std::size_t side) {
  const BoardRig& rig = calibrator.best().rig;
  CalibratedView view;
  const Corners used = board_residuals(rig, calibrator.positions(), p, side);
  view.seen = !used.empty();
  if (!view.seen) return view;
  view.residuals = board_residuals(rig, calibrator.measured(), p, side);
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (!used[i].allFinite()) {
      view.dropped.push_back(i);
      continue;
    }
    view.residuals[i] = used[i];
    sum += used[i].squaredNorm();
    ++count;
    view.max_px = std::max(view.max_px, used[i].norm());
  }
  view.rms_px = std::sqrt(sum / count);
  view.T_camera_board = side == 0 ? rig.T_left_board[p] : Eigen::Isometry3d(rig.T_right_left * rig.T_left_board[p]);
  view.tilt_rad = std::acos(std::min(1.0, std::abs(view.T_camera_board.linear()(2, 2))));
  return view;
}

double corners_used(const CalibratedView& view) {
  return static_cast<double>(view.residuals.size() - view.dropped.size());
}

// Views whose RMS is far above that of their side.
void mark_outliers(Calibration& c, std::size_t side, double factor) {
  std::vector<double> rms;
  for (const auto& view : c.views)
    if (view[side].seen) rms.push_back(view[side].rms_px);
  const auto middle = rms.begin() + static_cast<std::ptrdiff_t>(rms.size() / 2);
  std::nth_element(rms.begin(), middle, rms.end());
  const double limit = std::max(factor * *middle, BEST_CORNER_PX);
  for (auto& view : c.views) view[side].outlier = view[side].seen && view[side].rms_px > limit;
}

CalibratedCamera camera_of(const Calibration& c, const BoardAdjustment& a, std::size_t side) {
  CalibratedCamera result;
  result.camera = a.rig.cameras[side];
  const int at = 8 * static_cast<int>(side);
  result.covariance = c.sigma_px * c.sigma_px * a.inverse_information.block<8, 8>(at, at);
  result.deviation = result.covariance.diagonal().cwiseSqrt();
  double sum = 0, count = 0;
  for (const auto& view : c.views)
    if (view[side].seen) {
      sum += view[side].rms_px * view[side].rms_px * corners_used(view[side]);
      count += corners_used(view[side]);
    }
  result.rms_px = std::sqrt(sum / count);
  return result;
}

Calibration packed(const Board& board, const Calibrator& calibrator, std::size_t sides, const CalibrationOptions& o) {
  const BoardAdjustment& a = calibrator.best();
  Calibration c;
  c.rig = a.rig;
  c.positions = calibrator.positions();
  for (std::size_t p = 0; p < c.positions.size(); ++p)
    for (std::size_t side = 0; side < sides; ++side)
      for (std::size_t i = 0; i < c.positions[p].corners[side].size(); ++i)
        if (auto& corner = c.positions[p].corners[side][i]; !corner.allFinite())
          corner = calibrator.measured()[p].corners[side][i];
  c.sigma_px = calibrator.sigma_px();
  for (std::size_t p = 0; p < c.positions.size(); ++p) {
    c.views.emplace_back();
    for (std::size_t side = 0; side < sides; ++side) c.views[p][side] = view_of(calibrator, p, side);
  }
  for (std::size_t side = 0; side < sides; ++side) {
    mark_outliers(c, side, o.outlier_factor);
    c.cameras.push_back(camera_of(c, a, side));
  }
  double count = 0;
  for (const auto& views : c.views)
    for (const auto& view : views) count += corners_used(view);
  c.rms_px = std::sqrt(a.sum_of_squares_px2 / count);
  c.rig_covariance.setZero();
  if (sides == 2) c.rig_covariance = c.sigma_px * c.sigma_px * a.inverse_information.block<6, 6>(16, 16);
  const auto nominal = board.points();
  for (std::size_t i = 0; i < nominal.size(); ++i) {
    const double move = (c.rig.points[i] - nominal[i]).norm();
    c.board_max_m = std::max(c.board_max_m, move);
    c.board_rms_m += move * move / static_cast<double>(nominal.size());
  }
  c.board_rms_m = std::sqrt(c.board_rms_m);
  return c;
}

}  // namespace

Calibration calibrate(const Board& board, int width, int height, std::size_t sides,
                      const std::vector<BoardPosition>& positions, const CalibrationOptions& options) {
  std::size_t pictures = 0;
  for (std::size_t side = 0; side < sides; ++side) {
    const std::size_t views = views_of(positions, side);
    pictures += views;
    if (views < FEWEST_VIEWS)
      throw InputError(fmt::format("{}{} usable {}; take {} or more, better 10, with the board tilted to several sides",
                                   side_name(sides, side), views, views == 1 ? "view" : "views", FEWEST_VIEWS));
  }
  if (options.shape == BoardShape::FREE && pictures < FEWEST_VIEWS_FREE)
    throw InputError(fmt::format("{} views are too few to estimate the board's shape; take {} or more", pictures,
                                 FEWEST_VIEWS_FREE));
  Calibrator flat(board, width, height, sides, positions);
  flat.fit_flat();
  bool is_free = false;
  double evidence = 0;
  Calibrator free = flat;
  if (options.shape != BoardShape::FLAT && pictures >= FEWEST_VIEWS_FREE && is_determined(flat, sides)) {
    evidence = free.fit_free();
    const int extra = flat.best().degrees_of_freedom - free.best().degrees_of_freedom;
    is_free = options.shape == BoardShape::FREE ||
              (is_beyond_chance(evidence, extra, free.best().degrees_of_freedom) && is_determined(free, sides));
  }
  if (is_free) free.drop_gross_errors({true, true});
  const Calibrator& calibrator = is_free ? free : flat;
  require_determined(calibrator, sides);
  Calibration result = packed(board, calibrator, sides, options);
  result.free_board = is_free;
  result.shape_evidence = evidence;
  result.pair_strain = calibrator.pair_strain();
  return result;
}

}  // namespace heartservo::tracking
