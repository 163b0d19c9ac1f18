#include <cmath>
#include <cstdio>
#include <opencv2/core.hpp>

#include "tracking/frames/frame.hpp"
#include "tracking/planar/registry.hpp"

using namespace heartservo::tracking;

namespace {

Frame moved_by(double shift, std::uint64_t sequence) {
  Frame frame;
  frame.grey.create(120, 160, CV_8UC1);
  for (int v = 0; v < 120; ++v)
    for (int u = 0; u < 160; ++u)
      frame.grey.at<std::uint8_t>(v, u) = cv::saturate_cast<std::uint8_t>(
          128 + 50 * std::sin((u - shift) / 5.0) * std::cos(v / 6.0) + 25 * std::sin((u - shift + 1.7 * v) / 4.1));
  frame.sequence = sequence;
  frame.time_s = 0.008 * static_cast<double>(sequence);
  return frame;
}

}  // namespace

int main() {
  const auto tracker = trackers().make("esm", heartservo::tracking::Camera{}, TrackerOptions{});
  if (!tracker->start(moved_by(0, 0), rectangle(60, 40, 40, 40)).empty()) return 1;
  const Track track = tracker->track(moved_by(2.5, 1));
  std::printf("moved by %.3f px\n", track.corners[0].x() - 60);
  return track.state == TrackState::OK && std::abs(track.corners[0].x() - 62.5) < 0.05 ? 0 : 1;
}
