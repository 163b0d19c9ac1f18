#include "tracking/frames/video_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "tracking/frames/frame.hpp"
#include "tracking/frames/image_folder.hpp"
#include "tracking/frames/picture_file.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tracking {

namespace {

// OpenCV and FFmpeg tell stderr about files that they cannot open; the exception says it once.
class QuietOpenCv {
 public:
  QuietOpenCv() : level_(cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT)) {
    setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);  // read once, when the first video is opened; a user's own value stays
  }
  ~QuietOpenCv() { cv::utils::logging::setLogLevel(level_); }
  QuietOpenCv(const QuietOpenCv&) = delete;
  QuietOpenCv& operator=(const QuietOpenCv&) = delete;

 private:
  cv::utils::logging::LogLevel level_;
};

class VideoFile final : public FrameSource {
 public:
  VideoFile(const std::string& file, double frame_rate_hz) : file_(file) {
    const QuietOpenCv quiet;
    bool opened = false;
    try {
      opened = capture_.open(file, cv::CAP_FFMPEG) && capture_.read(first_) && !first_.empty();
    } catch (const cv::Exception&) {  // the same as not opened
    }
    if (!opened) throw InputError(file + ": is no video that can be decoded; convert it, for instance with ffmpeg");
    const double own_rate = capture_.get(cv::CAP_PROP_FPS);
    const auto usable = [](double rate) { return rate > 0 && rate < 1e5; };  // false for NaN
    rate_hz_ = usable(frame_rate_hz) ? frame_rate_hz : usable(own_rate) ? own_rate : PICTURE_RATE_HZ;
    const double count = capture_.get(cv::CAP_PROP_FRAME_COUNT);
    if (count >= 1 && count < 1e9) count_ = static_cast<std::size_t>(count);
    size_ = first_.size();
  }

  bool next(Frame& frame) override {
    cv::Mat picture = first_;  // a new one for every frame: whoever holds the last one keeps it
    first_ = cv::Mat();
    if (picture.empty() && !capture_.read(picture)) return false;
    frame = Frame{};
    frame.sequence = sequence_++;
    frame.time_s = static_cast<double>(frame.sequence) / rate_hz_;
    if (picture.size() != size_) {
      frame.status = FrameStatus::UNREADABLE;
      frame.note = fmt::format("{}: frame {} is {} x {} px, the first one {} x {}", file_, frame.sequence, picture.cols,
                               picture.rows, size_.width, size_.height);
    } else if (picture.channels() == 1) {
      frame.grey = picture;
    } else {
      frame.colour = picture;
      cv::cvtColor(picture, frame.grey, cv::COLOR_BGR2GRAY);
    }
    return true;
  }

  cv::Size size() const override { return size_; }
  double frame_rate_hz() const override { return rate_hz_; }
  std::optional<std::size_t> frame_count() const override { return count_; }
  std::string description() const override { return file_; }

 private:
  std::string file_;
  cv::VideoCapture capture_;
  cv::Mat first_;  // decoded on opening, to know that something can be
  cv::Size size_;
  double rate_hz_ = 0;
  std::optional<std::size_t> count_;
  std::uint64_t sequence_ = 0;
};

}  // namespace

std::unique_ptr<FrameSource> open_video_file(const std::string& file, double frame_rate_hz) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) throw InputError(file + ": no such video file; check the path");
  if (std::filesystem::file_size(file, error) == 0) throw InputError(file + ": is empty; name a video file");
  if (looks_like_text(file))  // FFmpeg would play it as an animation of letters
    throw InputError(file + ": is a text file, not a video; name pictures, a folder of them, or a video");
  return std::make_unique<VideoFile>(file, frame_rate_hz);
}

}  // namespace heartservo::tracking
