#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "tracking/planar/quad.hpp"

namespace heartservo::tracking {

enum class TrackState {
  OK,         ///< the region is followed
  UNCERTAIN,  ///< followed, but the picture fits badly (occlusion, glare, blur): use with care
  LOST,       ///< not found in this frame; corners are the last believed ones
};

const char* name_of(TrackState state);

/// Of the region, rows of a square grid.
inline constexpr int kGridSide = 7;
using PointGrid = std::array<Eigen::Vector2d, kGridSide * kGridSide>;

/// What a tracker says about one frame.
struct Track {
  double time_s = 0;           ///< of the frame
  std::uint64_t sequence = 0;  ///< of the frame
  TrackState state = TrackState::LOST;
  double quality = 0;  ///< 0 (nothing in common with the template) to 1 (identical)
  /// px, in the picture as taken (distorted). A tracker that bends the region gives its local homography: the corners
  /// as they would lie were the whole region shaped like its centre.
  Quad corners{};
  Eigen::Vector2d target = Eigen::Vector2d::Zero();  ///< px: where the centre of the region learnt now lies
  /// px: where points of the region learnt now lie, bent or not: a grid from its first corner to its third, the outer
  /// points half a step inside.
  PointGrid points{};
  Eigen::Matrix3d H_current_reference = Eigen::Matrix3d::Identity();  ///< on the undistorted pixel plane, det 1
  double gain = 1;                                                    ///< template grey = gain * picture grey + bias
  double bias = 0;                                                    ///< grey levels
  double noise_grey = 0;    ///< robust standard deviation of the remaining grey difference
  int iterations = 0;       ///< of the last alignment, all pyramid levels
  bool reacquired = false;  ///< found again in this frame after LOST
};

}  // namespace heartservo::tracking
