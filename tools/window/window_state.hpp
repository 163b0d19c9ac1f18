#pragma once
// What keys and clicks in the live window have led to. No window, no thread: those are live_window.hpp's.
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tracking/planar/quad.hpp"

namespace heartservo::tools {

class WindowState {
 public:
  /// What the loop is asked to do.
  struct Asked {
    bool quit = false;
    bool relearn = false;                  ///< the region anew, where it is now
    std::optional<tracking::Quad> region;  ///< this region instead; px of the picture
  };

  /// Space pauses and goes on; r drops the corners clicked so far, and where there are none asks for the region to be
  /// learnt anew; q ends.
  void key(const std::string& name);
  /// While paused four clicks, snapped to corners of `grey`, are a region. Elsewhere they mean nothing.
  void click(const Eigen::Vector2d& px, const cv::Mat& grey);
  void close() { asked_.quit = true; }

  /// Waits for a region, and goes on when it is there.
  void ask_for_region() { paused_ = goes_on_ = true; }

  bool paused() const { return paused_; }
  const std::vector<Eigen::Vector2d>& clicks() const { return clicks_; }
  std::string keys() const;  ///< what they do now, a line for people

  /// What has been asked since the last call.
  Asked take();

 private:
  bool paused_ = false, goes_on_ = false;
  std::vector<Eigen::Vector2d> clicks_;
  std::string complaint_;
  Asked asked_;
};

/// The corner of `grey` next to where someone clicked, to a part of a pixel; `px` itself where there is none within
/// 5 px.
Eigen::Vector2d snapped(const cv::Mat& grey, const Eigen::Vector2d& px);

}  // namespace heartservo::tools
