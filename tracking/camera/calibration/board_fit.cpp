#include "tracking/camera/calibration/board_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tracking/camera/calibration/calibration_start.hpp"
#include "tracking/camera/calibration/disc_offset.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tracking {

namespace {

constexpr double GROSS = 6;  // standard deviations; chance gives it to one corner in 10^7
constexpr double TORN = 5;   // times worse together than alone: no pair

// A disc's picture has its centre of gravity elsewhere than the picture of its centre: what was measured, less that.
std::vector<BoardPosition> without_disc_offsets(const std::vector<BoardPosition>& measured, const BoardRig& rig,
                                                double diameter_m) {
  auto result = measured;
  for (std::size_t p = 0; p < result.size(); ++p)
    for (std::size_t side = 0; side < rig.cameras.size(); ++side) {
      const Eigen::Isometry3d T = board_pose(rig, p, side);
      for (std::size_t i = 0; i < result[p].corners[side].size(); ++i)
        result[p].corners[side][i] -= disc_offset(rig.cameras[side], T, rig.points[i], diameter_m);
    }
  return result;
}

// A corner's standard deviation from the median length of residuals, which gross errors do not move; 1.177 sigma is
// that of a round Gaussian.
double robust_sigma(const Corners& residuals) {
  std::vector<double> sizes;
  for (const auto& r : residuals) sizes.push_back(r.norm());
  if (sizes.empty()) return 0;
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  return *middle / 1.177;
}

}  // namespace

BoardFit::BoardFit(const Board& board, int width, int height, std::size_t sides,
                   const std::vector<BoardPosition>& positions)
    : board_(board),
      width_(width),
      height_(height),
      sides_(sides),
      measured_(positions),
      corrected_(positions),
      used_(positions) {}

void BoardFit::fit_flat() {
  best_ = calibrate_one_camera(board_, width_, height_, used_, 0);
  if (sides_ == 2) {
    const auto left = best_, right = calibrate_one_camera(board_, width_, height_, used_, 1);
    best_ = calibrate_two_cameras(board_, left, right, used_);
    const double alone = left.sum_of_squares_px2 + right.sum_of_squares_px2;
    if (alone > 1e-12) pair_strain_ = std::sqrt(best_.sum_of_squares_px2 / alone);
    if (pair_strain_ > TORN)
      throw InputError(
          fmt::format("left and right views fit {:.0f} times worse together than alone; give both sides in the same "
                      "order, and take the pictures of a pair at the same time",
                      pair_strain_));
  }
  correct_discs({});
  leave_out_gross_errors({});
}

double BoardFit::fit_free() {
  const BoardAdjustment flat = best_;
  const FreeParts free{true, true};
  best_ = adjust_board_rig(flat.rig, used_, free);
  for (int round = 0; round < 4 && renumber(); ++round) best_ = adjust_board_rig(best_.rig, used_, free);
  correct_discs(free);
  const int extra = flat.degrees_of_freedom - best_.degrees_of_freedom;  // before the data change
  const double F = (flat.sum_of_squares_px2 - best_.sum_of_squares_px2) / extra /
                   (best_.sum_of_squares_px2 / best_.degrees_of_freedom);
  leave_out_gross_errors(free);
  return F;
}

double BoardFit::sigma_px() const {
  return best_.degrees_of_freedom > 0 ? std::sqrt(best_.sum_of_squares_px2 / best_.degrees_of_freedom) : 0;
}

void BoardFit::leave_out_gross_errors(const FreeParts& free) {
  for (int round = 0; round < 6 && choose_corners(); ++round) best_ = adjust_board_rig(best_.rig, used_, free);
}

bool BoardFit::choose_corners() {
  Corners all;
  for (std::size_t p = 0; p < corrected_.size(); ++p)
    for (std::size_t side = 0; side < sides_; ++side)
      for (const auto& r : board_residuals(best_.rig, corrected_, p, side)) all.push_back(r);
  const double of_all = std::max(robust_sigma(all), BEST_CORNER_PX);
  bool changed = false;
  for (std::size_t p = 0; p < corrected_.size(); ++p)
    for (std::size_t side = 0; side < sides_; ++side) {
      const Corners residuals = board_residuals(best_.rig, corrected_, p, side);
      const double sigma = std::max(robust_sigma(residuals), of_all);
      for (std::size_t i = 0; i < residuals.size(); ++i) {
        auto& corner = used_[p].corners[side][i];
        const bool keep = residuals[i].norm() <= GROSS * sigma;
        changed |= keep != corner.allFinite();
        corner = corrected_[p].corners[side][i];
        if (!keep) corner.setConstant(std::numeric_limits<double>::quiet_NaN());
      }
    }
  return changed;
}

void BoardFit::correct_discs(const FreeParts& free) {
  for (int round = 0; board_.disc_m > 0 && round < 3; ++round) {
    corrected_ = without_disc_offsets(measured_, best_.rig, board_.disc_m);
    for (std::size_t p = 0; p < used_.size(); ++p)
      for (std::size_t side = 0; side < sides_; ++side)
        for (std::size_t i = 0; i < used_[p].corners[side].size(); ++i)
          if (auto& corner = used_[p].corners[side][i]; corner.allFinite()) corner = corrected_[p].corners[side][i];
    best_ = adjust_board_rig(best_.rig, used_, free);
  }
}

bool BoardFit::renumber() {
  const auto orders = same_looking_orders(board_);
  bool changed = false;
  for (std::size_t p = 0; p < used_.size(); ++p) {
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
    for (auto* positions : {&measured_, &corrected_, &used_})
      for (auto& corners : (*positions)[p].corners)
        if (!corners.empty()) corners = reordered(corners, orders[best_order]);
  }
  return changed;
}

std::pair<double, Eigen::Isometry3d> BoardFit::cost_of(std::size_t p, const std::vector<std::size_t>& order,
                                                       const std::vector<std::size_t>& identity,
                                                       const std::vector<Eigen::Vector3d>& nominal) const {
  BoardRig rig = best_.rig;
  BoardPosition position = used_[p];
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

}  // namespace heartservo::tracking
