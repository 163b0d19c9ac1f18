#include "tools/capture/picture_writer.hpp"

#include <fmt/format.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "tracking/frames/recording.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tools {

namespace {

class Ffv1 final : public PictureWriter {
 public:
  Ffv1(const std::filesystem::path& folder, cv::Size size, bool colour, double rate_hz)
      : file_((folder / tracking::RECORDED_VIDEO).string()) {
    setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);
    bool opened = false;
    try {
      opened = writer_.open(file_, cv::CAP_FFMPEG, cv::VideoWriter::fourcc('F', 'F', 'V', '1'), rate_hz, size,
                            {cv::VIDEOWRITER_PROP_IS_COLOR, colour ? 1 : 0});
    } catch (const cv::Exception&) {  // the same as not opened
    }
    if (!opened) throw ConfigError(file_ + ": cannot be written as FFV1; try --png");
  }
  void write(const cv::Mat& picture) override { writer_.write(picture); }
  void finish() override { writer_.release(); }

 private:
  std::string file_;
  cv::VideoWriter writer_;
};

class Pngs final : public PictureWriter {
 public:
  explicit Pngs(const std::filesystem::path& folder) : folder_(folder / tracking::RECORDED_PICTURES) {
    std::error_code error;
    std::filesystem::create_directories(folder_, error);
    if (error) throw ConfigError(fmt::format("{}: cannot be made: {}", folder_.string(), error.message()));
  }
  void write(const cv::Mat& picture) override {
    const std::string file = folder_ / fmt::format("{:06}.png", count_);
    bool written = false;
    try {
      written = cv::imwrite(file, picture, {cv::IMWRITE_PNG_COMPRESSION, 1});
    } catch (const cv::Exception&) {  // the same as not written
    }
    if (!written) {
      std::error_code ignored;
      std::filesystem::remove(file, ignored);  // half a picture is none
      throw ConfigError(file + ": cannot be written");
    }
    ++count_;
  }
  void finish() override {}

 private:
  std::filesystem::path folder_;
  std::size_t count_ = 0;
};

}  // namespace

std::unique_ptr<PictureWriter> write_ffv1(const std::filesystem::path& folder, cv::Size size, bool colour,
                                          double rate_hz) {
  return std::make_unique<Ffv1>(folder, size, colour, rate_hz);
}

std::unique_ptr<PictureWriter> write_pngs(const std::filesystem::path& folder) {
  return std::make_unique<Pngs>(folder);
}

}  // namespace heartservo::tools
