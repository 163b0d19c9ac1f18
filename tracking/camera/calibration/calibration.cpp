#include "tracking/camera/calibration/calibration.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "tracking/camera/calibration/board_fit.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tracking {

namespace {

constexpr std::size_t FEWEST_VIEWS = 3;
constexpr std::size_t FEWEST_VIEWS_FREE = 6;     // pictures, to tell the board's shape from the lens
constexpr std::size_t LARGEST_FREE_BOARD = 700;  // points; memory grows by the square of their number
constexpr double VAGUE_DISTORTION = 1e12;        // variance for corners of 1 px
constexpr double VAGUE = 0.05;                   // of a focal length, or of the picture: not determined

std::size_t views_of(const std::vector<BoardPosition>& positions, std::size_t side) {
  return static_cast<std::size_t>(std::count_if(positions.begin(), positions.end(),
                                                [&](const BoardPosition& p) { return !p.corners[side].empty(); }));
}

const char* side_name(std::size_t sides, std::size_t side) {
  return sides == 1 ? "" : side == 0 ? "left: " : "right: ";
}

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
  for (int k = 4; k < 8; ++k)
    if (const auto at = 8 * static_cast<int>(side) + k; !(a.inverse_information(at, at) < VAGUE_DISTORTION))
      result.emplace_back(CAMERA_PARAMETER_NAMES[k]);
  return result;
}

bool is_determined(const BoardFit& fit, std::size_t sides) {
  for (std::size_t side = 0; side < sides; ++side)
    if (!vague_parameters(fit.best(), side, fit.sigma_px()).empty()) return false;
  return true;
}

void require_determined(const BoardFit& fit, std::size_t sides) {
  const BoardAdjustment& a = fit.best();
  for (std::size_t side = 0; side < sides; ++side) {
    const auto vague = vague_parameters(a, side, fit.sigma_px());
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

CalibratedView view_of(const BoardFit& fit, std::size_t p, std::size_t side) {
  const BoardRig& rig = fit.best().rig;
  CalibratedView view;
  view.residuals = board_residuals(rig, fit.corrected(), p, side);
  view.seen = !view.residuals.empty();
  if (!view.seen) return view;
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < view.residuals.size(); ++i) {
    if (!fit.used()[p].corners[side][i].allFinite()) {
      view.dropped.push_back(i);
      continue;
    }
    sum += view.residuals[i].squaredNorm();
    ++count;
    view.max_px = std::max(view.max_px, view.residuals[i].norm());
  }
  view.rms_px = std::sqrt(sum / count);
  view.T_camera_board = board_pose(rig, p, side);
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

Calibration packed(const Board& board, const BoardFit& fit, std::size_t sides, const CalibrationOptions& o) {
  const BoardAdjustment& a = fit.best();
  Calibration c;
  c.rig = a.rig;
  c.positions = fit.corrected();
  c.sigma_px = fit.sigma_px();
  for (std::size_t p = 0; p < c.positions.size(); ++p) {
    c.views.emplace_back();
    for (std::size_t side = 0; side < sides; ++side) c.views[p][side] = view_of(fit, p, side);
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
  const bool can_be_free = pictures >= FEWEST_VIEWS_FREE && board.size() <= LARGEST_FREE_BOARD;
  if (options.shape == BoardShape::FREE && !can_be_free)
    throw InputError(
        fmt::format("the shape of a board of {} points cannot be estimated from {} views; take {} or more "
                    "of a board of at most {}",
                    board.size(), pictures, FEWEST_VIEWS_FREE, LARGEST_FREE_BOARD));
  BoardFit flat(board, width, height, sides, positions);
  flat.fit_flat();
  bool is_free = false;
  double evidence = 0;
  BoardFit free = flat;
  if (options.shape != BoardShape::FLAT && can_be_free && is_determined(flat, sides)) {
    evidence = free.fit_free();
    const int extra = flat.best().degrees_of_freedom - free.best().degrees_of_freedom;
    is_free = options.shape == BoardShape::FREE ||
              (is_beyond_chance(evidence, extra, free.best().degrees_of_freedom) && is_determined(free, sides));
  }
  const BoardFit& chosen = is_free ? free : flat;
  require_determined(chosen, sides);
  Calibration result = packed(board, chosen, sides, options);
  result.free_board = is_free;
  result.shape_evidence = evidence;
  result.pair_strain = chosen.pair_strain();
  return result;
}

}  // namespace heartservo::tracking
