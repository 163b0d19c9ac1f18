#include "tracking/frames/open_source.hpp"

#include <filesystem>
#include <opencv2/imgcodecs.hpp>

#include "tracking/frames/image_folder.hpp"
#include "tracking/frames/picture_file.hpp"
#include "tracking/frames/recording.hpp"
#include "tracking/frames/v4l2/v4l2_camera.hpp"
#include "tracking/frames/video_file.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tracking {

std::unique_ptr<FrameSource> open_source(const std::string& source, double frame_rate_hz) {
  std::error_code error;
  if (source.empty()) throw InputError("the source is an empty name; give a folder, a pattern, a picture or a video");
  if (v4l2::is_camera(source)) {
    v4l2::CameraOptions options = v4l2::parse_camera(source);
    if (frame_rate_hz > 0 && options.rate_hz <= 0) options.rate_hz = frame_rate_hz;
    return v4l2::open_v4l2_camera(options, false);
  }
  if (std::filesystem::is_directory(source, error) && is_recording(source)) return open_recording(source);
  if (std::filesystem::is_directory(source, error)) return open_image_folder(source, frame_rate_hz);
  if (!std::filesystem::exists(source, error)) {
    if (source.find('%') != std::string::npos) return open_image_folder(source, frame_rate_hz);
    throw InputError(source + ": no such file or folder; check the path");
  }
  if (has_picture_name(source) || cv::haveImageReader(source)) return open_image_files({source}, frame_rate_hz, source);
  return open_video_file(source, frame_rate_hz);
}

}  // namespace heartservo::tracking
