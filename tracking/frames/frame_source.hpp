#pragma once
#include <cstddef>
#include <opencv2/core/types.hpp>
#include <optional>
#include <string>

namespace heartservo::tracking {

struct Frame;
class LiveSource;

/// Where frames come from: a folder, a video, a camera, a simulated endoscope.
class FrameSource {
 public:
  virtual ~FrameSource() = default;

  /// Fills `frame` with the next frame; false at the end. A frame that is broken is returned with its status, and the
  /// sequence goes on. Throws InputError or DeviceError only when nothing more can come.
  virtual bool next(Frame& frame) = 0;

  virtual cv::Size size() const = 0;                            ///< px
  virtual double frame_rate_hz() const = 0;                     ///< nominal
  virtual std::optional<std::size_t> frame_count() const = 0;  ///< if it is known before the end
  virtual std::string description() const = 0;                  ///< for people and summary.json: a path or a scene
  /// The camera behind it (live_source.hpp); null for frames that wait until they are asked for.
  virtual LiveSource* live() { return nullptr; }
};

}  // namespace heartservo::tracking
