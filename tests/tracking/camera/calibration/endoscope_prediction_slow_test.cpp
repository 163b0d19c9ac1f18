#include <gtest/gtest.h>

#include "tests/tracking/camera/calibration/endoscope_lists.hpp"
#include "tracking/camera/calibration/calibration.hpp"

namespace heartservo::tracking {
namespace {

using namespace test::endoscope;

// Each pair in turn is kept out of the calibration; cameras, rig and board of the others must predict it.
TEST(EndoscopeCalibration, PredictsPairsThatItHasNotSeen) {
  SKIP_WITHOUT_DATA(folder());
  const auto all = positions_of({"left", "right"});
  const auto error_px = [&](BoardShape shape) {
    std::vector<double> errors;
    for (std::size_t held_out = 0; held_out < all.size(); ++held_out) {
      auto others = all;
      others.erase(others.begin() + static_cast<std::ptrdiff_t>(held_out));
      BoardRig rig = calibrate(BOARD, 1920, 1080, 2, others, {shape}).rig;
      rig.T_left_board = {calibrate(BOARD, 1920, 1080, 2, all, {BoardShape::FLAT}).rig.T_left_board[held_out]};
      const auto fitted = adjust_board_rig(rig, {all[held_out]}, {false, false});
      for (std::size_t side = 0; side < 2; ++side)
        for (const auto& r : board_residuals(fitted.rig, {all[held_out]}, 0, side)) errors.push_back(r.norm());
    }
    std::nth_element(errors.begin(), errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2), errors.end());
    return errors[errors.size() / 2];
  };
  const double free = error_px(BoardShape::AUTO), flat = error_px(BoardShape::FLAT);
  EXPECT_LT(free, 0.35);
  EXPECT_LT(free, 0.65 * flat);
}

}  // namespace
}  // namespace heartservo::tracking
