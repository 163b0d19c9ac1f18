#pragma once
#include <filesystem>
#include <memory>
#include <opencv2/core/mat.hpp>

namespace heartservo::tools {

/// Writes pictures without loss, one after the other, all of one size and kind (grey or BGR, 8 bit).
class PictureWriter {
 public:
  virtual ~PictureWriter() = default;
  /// Throws ConfigError when it cannot be written.
  virtual void write(const cv::Mat& picture) = 0;
  /// Until then the last pictures may not be in the file.
  virtual void finish() = 0;
};

/// FFV1 in Matroska: `folder`/video.mkv. A file that was cut off by a crash can be read up to its last second.
std::unique_ptr<PictureWriter> write_ffv1(const std::filesystem::path& folder, cv::Size size, bool colour,
                                          double rate_hz);

/// `folder`/pictures/000000.png, ...
std::unique_ptr<PictureWriter> write_pngs(const std::filesystem::path& folder);

}  // namespace heartservo::tools
