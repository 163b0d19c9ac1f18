#pragma once
// A camera, or a stereo pair, from pictures of a board: Zhang's method (2000) for the model of eq. 1-4.
#include <array>
#include <vector>

#include "tracking/camera/calibration/board_adjustment.hpp"
#include "tracking/camera/camera_jacobian.hpp"

namespace heartservo::tracking {

/// Printed boards are neither flat nor true to size within 0.1 mm, which at 100 mm shows as a pixel. FREE estimates the
/// place of every point of the board along with the rest (Strobl & Hirzinger, "More accurate pinhole camera calibration
/// with imperfect planar target", 2011); AUTO does so when the pictures show beyond doubt that the board is not as
/// printed.
enum class BoardShape { AUTO, FLAT, FREE };

struct CalibrationOptions {
  BoardShape shape = BoardShape::AUTO;
  double outlier_factor = 2;  ///< a view is an outlier above this many times the median RMS of its side
};

struct CalibratedCamera {
  Camera camera;
  Eigen::Matrix<double, 8, 8> covariance;  ///< of camera_jacobian.hpp's parameters
  CameraParameters deviation;              ///< standard deviations, the root of its diagonal
  double rms_px = 0;                       ///< root mean square distance of corners from where the model has them
};

/// One picture.
struct CalibratedView {
  bool seen = false;  ///< false: nothing below is valid
  bool outlier = false;
  double rms_px = 0, max_px = 0;                                     ///< distances of the corners used
  Eigen::Isometry3d T_camera_board = Eigen::Isometry3d::Identity();  ///< m
  double tilt_rad = 0;                                               ///< of the board against the picture plane
  Corners residuals;                                                 ///< px, measured less computed, of all corners
  std::vector<std::size_t> dropped;  ///< corners far outside of what the view's others show, that were left out
};

struct Calibration {
  std::vector<CalibratedCamera> cameras;             ///< one, or left and right
  BoardRig rig;                                      ///< T_right_left, poses, the board's points
  Eigen::Matrix<double, 6, 6> rig_covariance;        ///< of the twist (m, rad) of T_right_left; 0 for one camera
  std::vector<BoardPosition> positions;              ///< as used: points renumbered, centres of circles corrected
  std::vector<std::array<CalibratedView, 2>> views;  ///< one pair a position
  double rms_px = 0;                                 ///< over all corners
  double sigma_px = 0;                               ///< standard deviation of a corner in u and in v
  bool free_board = false;                           ///< the board's shape was estimated
  double board_rms_m = 0, board_max_m = 0;           ///< how far its points are from their nominal places
  double pair_strain = 1;  ///< RMS of a flat board with both cameras in one rig, over that with each alone; 1 when they
                           ///< are rigidly joined and took each pair at one time
  double shape_evidence = 0;  ///< F ratio of the free board against the flat one; 1 by chance
};

/// `positions` hold one or two sides, each corner list of board.size() points in px; all views of one side have the
/// same picture size. Throws InputError that says what to do: fewer than three views of a side or of both together,
/// views that do not determine the camera (boards all parallel, ...), a lens model that folds inside the picture.
Calibration calibrate(const Board& board, int width, int height, std::size_t sides,
                      const std::vector<BoardPosition>& positions, const CalibrationOptions& options = {});

}  // namespace heartservo::tracking
