#pragma once
// The pictures of a `track` run.
#include <opencv2/core.hpp>
#include <vector>

#include "tools/album.hpp"
#include "tools/track_run.hpp"

namespace heartservo::tools {

/// The start, the middle, the worst moment of any lane (its largest error with truth, else its lowest quality) and the
/// first frame that any lane lost, each with all regions, the true place of the point, and the pixels that the first
/// lane leaves out. With them the trajectories in the picture (the paper's Fig. 7).
class TrackAlbum {
 public:
  /// `expected_frames`: 0 where nobody knows.
  TrackAlbum(std::size_t expected_frames, TruthKind truth, const tracking::Frame& first);

  /// After the lanes have followed the frame, while its pixels are there.
  void look_at(const tracking::Frame& frame, std::vector<TrackLane>& lanes, const TrackTruth& truth);

  /// The trajectories come second, after the start.
  std::vector<ReportPicture> pictures(const std::vector<TrackLane>& lanes) const;

 private:
  TruthKind truth_;
  cv::Mat first_bgr_;
  Album album_;
  std::size_t count_ = 0;
};

}  // namespace heartservo::tools
