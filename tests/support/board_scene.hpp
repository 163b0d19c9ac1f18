#pragma once
// Boards before a camera: poses all over the working volume, corners with noise, and pictures drawn through the lens.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "tests/support/random.hpp"
#include "tracking/camera/calibration/board_adjustment.hpp"

namespace heartservo::test {

/// The board that fits the paper's endoscope: 20 x 15 mm of it at 55 mm.
inline tracking::Board small_board(tracking::BoardKind kind = tracking::BoardKind::CHESSBOARD) {
  return {kind, 9, 7, 0.0025, 0};
}

inline Eigen::Isometry3d board_pose(const Eigen::Vector3d& place_m, double tilt_rad, double towards_rad,
                                    double roll_rad) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  const Eigen::Vector3d axis(std::cos(towards_rad), std::sin(towards_rad), 0);
  T.linear() = (Eigen::AngleAxisd(tilt_rad, axis) * Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitZ())).matrix();
  T.translation() = place_m;
  return T;
}

/// Poses at 45 to 70 mm with the whole board in the picture, tilted by up to `largest_tilt` to every side.
inline std::vector<Eigen::Isometry3d> board_poses(std::mt19937_64& random, const tracking::Camera& camera,
                                                  const tracking::Board& board, int count, double largest_tilt = 0.7) {
  std::vector<Eigen::Isometry3d> poses;
  while (static_cast<int>(poses.size()) < count) {
    const double z = uniform(random, 0.045, 0.07);
    const Eigen::Vector3d place(uniform(random, -0.2, 0.2) * z, uniform(random, -0.2, 0.2) * z, z);
    const auto T = board_pose(place, uniform(random, 0.4 * largest_tilt, largest_tilt), uniform(random, 0, 2 * M_PI),
                              uniform(random, -0.4, 0.4));
    bool inside = true;
    const double rim = board.pitch_m;  // the outer squares, too
    for (const double x : {-1, 1})
      for (const double y : {-1, 1}) {
        const Eigen::Vector3d corner(x * (0.5 * (board.columns - 1) * board.pitch_m + rim),
                                     y * (0.5 * (board.rows - 1) * board.pitch_m + rim), 0);
        const Eigen::Vector2d pixel = camera.project(T * corner);
        inside &= pixel.x() > 4 && pixel.y() > 4 && pixel.x() < camera.width - 5 && pixel.y() < camera.height - 5;
      }
    if (inside) poses.push_back(T);
  }
  return poses;
}

/// What the camera sees of `points` of a board at T, with noise.
inline tracking::Corners board_corners(std::mt19937_64& random, const tracking::Camera& camera,
                                       const std::vector<Eigen::Vector3d>& points, const Eigen::Isometry3d& T,
                                       double sigma_px) {
  tracking::Corners corners;
  for (const auto& point : points)
    corners.emplace_back(camera.project(T * point) +
                         Eigen::Vector2d(normal(random, sigma_px), normal(random, sigma_px)));
  return corners;
}

/// Draws pictures of a board through the distorted camera: white paper that reaches 0.8 pitch beyond the squares, on a
/// grey table, light that falls off to one side, three by three samples a pixel.
class BoardPainter {
 public:
  explicit BoardPainter(const tracking::Camera& camera) : camera_(camera) {
    for (int v = 0; v < SAMPLES * camera.height; ++v)
      for (int u = 0; u < SAMPLES * camera.width; ++u)
        rays_.push_back(camera.normalise({(u + 0.5) / SAMPLES - 0.5, (v + 0.5) / SAMPLES - 0.5}).cast<float>());
  }

  cv::Mat paint(const tracking::Board& board, const Eigen::Isometry3d& T_camera_board, double sigma_grey,
                std::mt19937_64& random) const {
    cv::Mat picture(camera_.height, camera_.width, CV_8UC1);
    const Eigen::Isometry3d T = T_camera_board.inverse();  // camera to board
    for (int v = 0; v < camera_.height; ++v)
      for (int u = 0; u < camera_.width; ++u) {
        double sum = 0;
        for (int j = 0; j < SAMPLES; ++j)
          for (int i = 0; i < SAMPLES; ++i) {
            const auto ray =
                rays_[static_cast<std::size_t>((SAMPLES * v + j) * SAMPLES * camera_.width + SAMPLES * u + i)];
            const Eigen::Vector3d d = T.linear() * Eigen::Vector3d(ray.x(), ray.y(), 1);
            const Eigen::Vector3d p = T.translation() - T.translation().z() / d.z() * d;
            sum += reflectance(board, p.x() / board.pitch_m, p.y() / board.pitch_m);
          }
        const double light = 1 - 0.3 * u / camera_.width - 0.2 * v / camera_.height;
        const double grey = 230 * light * sum / (SAMPLES * SAMPLES) + normal(random, sigma_grey);
        picture.at<std::uint8_t>(v, u) = cv::saturate_cast<std::uint8_t>(grey);
      }
    return picture;
  }

 private:
  static constexpr int SAMPLES = 3;

  // x, y in pitches from the board's centre.
  static double reflectance(const tracking::Board& board, double x, double y) {
    const double column = x + 0.5 * (board.columns - 1), row = y + 0.5 * (board.rows - 1);
    const bool chess = board.kind == tracking::BoardKind::CHESSBOARD;
    if (column < -1.8 || row < -1.8 || column > board.columns + 0.8 || row > board.rows + 0.8) return 0.35;
    if (!chess) {
      const double c = std::round(column), r = std::round(row);
      const bool is_disc = c >= 0 && r >= 0 && c < board.columns && r < board.rows;
      return is_disc && std::hypot(column - c, row - r) < 0.5 * board.disc_m / board.pitch_m ? 0.08 : 1;
    }
    if (column < -1 || row < -1 || column > board.columns || row > board.rows) return 1;
    return (static_cast<int>(std::floor(column)) + static_cast<int>(std::floor(row))) % 2 == 0 ? 0.08 : 1;
  }

  tracking::Camera camera_;
  std::vector<Eigen::Vector2f> rays_;
};

}  // namespace heartservo::test
