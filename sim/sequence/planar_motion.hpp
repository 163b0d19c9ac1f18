#pragma once
// How the region of an artificial sequence moves. t counts frames; every motion is the identity at t = 0. Sequences a
// to e are those on which other planar trackers were measured; periods in frames:
//
//   a       x = 40 sin(2 pi t/100)
//   b       circle of radius 30 px: x = 30 (cos(2 pi t/100) - 1), y = 30 sin(2 pi t/100); rotation 20 deg sin(2 pi
//   t/80);
//           scale 1 + 0.10 sin(2 pi t/67); perspective 2e-4 sin(2 pi t/90), 1.5e-4 sin(2 pi t/60) per px
//   c       b with 16 moving saturated blobs and noise of 4 grey levels
//   d       x = 60 sin(2 pi t/27), y = 25 sin(2 pi t/41); rotation 8 deg sin(2 pi t/33): 14.4 px in the fastest frame
//   e       b with gain 1 + 0.25 sin(2 pi t/45) and bias 15 sin(2 pi t/30) grey levels
//   cde     b and d added (places, angles), with the blobs and noise of c and the light of e
//   fast    x = 75 sin(2 pi t/27), y = 55 sin(2 pi t/19); rotation 8 deg sin(2 pi t/33): 24.9 px in the fastest frame
//   table5  y = 20 sin(2 pi t/50): the vertical translation of Sauvee et al., section 4.4 (100 frames at 100 Hz)
//   circle  radius 40 px (t/100); rotation 30 deg sin(2 pi t/80); scale 1 + 0.10 sin(2 pi t/67): their Fig. 7
#include <Eigen/Core>
#include <string>
#include <vector>

namespace heartservo::sim {

/// Where and how the region is seen in one frame.
struct PlanarView {
  Eigen::Vector2d shift_px{0, 0};  ///< of the region's centre
  double angle_rad = 0;            ///< clockwise in the picture
  double scale = 1;
  Eigen::Vector2d perspective{0, 0};  ///< per px from the region's centre
  double gain = 1;                    ///< on all light
  double bias = 0;                    ///< grey levels
};

/// A sequence by name, with what it has unless asked otherwise.
struct SequenceKind {
  std::string name, summary;
  int frames = 151;
  double frame_rate_hz = 125;
  double noise_grey = 1;                   ///< standard deviation
  int speculars = 0;                       ///< moving saturated blobs
  double gain = 0;                         ///< amplitude of the gain's swing, period 45 frames
  double bias_grey = 0;                    ///< amplitude of the bias's swing, period 30 frames
  bool patch = false;                      ///< a small patch over a heart sequence; else the whole picture moves
  PlanarView (*view)(double t) = nullptr;  ///< gain and bias left alone
};

const std::vector<SequenceKind>& sequence_kinds();

/// Throws ConfigError for an unknown name, with a suggestion.
const SequenceKind& sequence_kind(const std::string& name);

/// The homography (lower right element 1) that takes a point of the first frame to its place in the frame seen with
/// `view`; the region's centre is at `centre_px` in the first frame. H = T(centre + shift) [s R, 0; p^T, 1] T(-centre).
Eigen::Matrix3d homography_of(const PlanarView& view, const Eigen::Vector2d& centre_px);

}  // namespace heartservo::sim
