#include "tools/short_video.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <optional>

#include "tools/image_motion.hpp"
#include "tracking/frames/frame.hpp"
#include "tracking/settings/errors.hpp"
#include "tracking/still/still_view.hpp"

namespace heartservo::tools {

namespace {

constexpr double kPictures_hz = 25, kLength_s = 4;
constexpr int kPanel_px = 256;  // widest; a page with this video stays near a megabyte

// While it lives, stderr writes nowhere: OpenCV prints that WebM knows no tag for VP8, which is no fault of anybody's.
class MutedStderr {
 public:
  MutedStderr() : kept_(::dup(STDERR_FILENO)) {
    std::fflush(stderr);
    if (const int nowhere = ::open("/dev/null", O_WRONLY); nowhere >= 0) {
      ::dup2(nowhere, STDERR_FILENO);
      ::close(nowhere);
    }
  }
  ~MutedStderr() {
    std::fflush(stderr);
    if (kept_ < 0) return;
    ::dup2(kept_, STDERR_FILENO);
    ::close(kept_);
  }
  MutedStderr(const MutedStderr&) = delete;
  MutedStderr& operator=(const MutedStderr&) = delete;

 private:
  int kept_;
};

}  // namespace

struct ShortVideo::Parts {
  std::filesystem::path file;
  double from_s, rate_hz, next_s;
  cv::Size panel;
  tracking::StillView view;
  std::optional<ImageMotion> raw;  // where the region is in the first picture of the video
  ImageMotion still;
  cv::VideoWriter writer;
  cv::Mat both, still_bgr;
  int pictures = 0;
  double last_s = NAN;

  Parts(std::filesystem::path f, double from, double rate, const tracking::Quad& region, cv::Size size)
      : file(std::move(f)),
        from_s(from),
        rate_hz(std::min(rate, kPictures_hz)),
        next_s(from),
        view(region, size),
        still(region) {
    const double scale = std::min(1.0, static_cast<double>(kPanel_px) / size.width);
    const auto even = [&](int length) { return std::max(2, static_cast<int>(scale * length) & ~1); };
    panel = {even(size.width), even(size.height)};
  }
};

ShortVideo::ShortVideo(const std::filesystem::path& file, double from_s, double frame_rate_hz,
                       const tracking::Quad& region, cv::Size size)
    : parts_(std::make_unique<Parts>(file, from_s, frame_rate_hz, region, size)) {}

ShortVideo::~ShortVideo() = default;

bool ShortVideo::wants(const tracking::Frame& frame) const {
  const double slack = 1e-6;  // a frame's time is a rounded multiple of the period
  return frame.status == tracking::FrameStatus::OK && !frame.grey.empty() && frame.time_s >= parts_->next_s - slack &&
         frame.time_s < parts_->from_s + kLength_s;
}

void ShortVideo::add(const tracking::Frame& frame, const cv::Mat& drawn, const tracking::TargetTracker& tracker,
                     const tracking::Track& track) {
  Parts& p = *parts_;
  if (p.pictures == 0) {
    if (track.state == tracking::TrackState::LOST) return;
    p.raw.emplace(track.corners);
    const cv::Size size(2 * p.panel.width, p.panel.height);
    const MutedStderr muted;
    if (!p.writer.open(p.file.string(), cv::CAP_FFMPEG, cv::VideoWriter::fourcc('V', 'P', '8', '0'), p.rate_hz, size))
      throw ConfigError(p.file.string() + ": the video cannot be written; check space and permissions");
    p.both.create(size, CV_8UC3);
    p.from_s = frame.time_s;
  }
  const cv::Mat& still = p.view.update(frame.grey, tracker, track);
  p.raw->add(frame.grey);
  p.still.add(still);
  cv::Mat left = p.both.colRange(0, p.panel.width), right = p.both.colRange(p.panel.width, 2 * p.panel.width);
  cv::resize(drawn, left, p.panel, 0, 0, cv::INTER_AREA);
  cv::cvtColor(still, p.still_bgr, cv::COLOR_GRAY2BGR);
  cv::resize(p.still_bgr, right, p.panel, 0, 0, cv::INTER_AREA);
  p.writer.write(p.both);
  ++p.pictures;
  p.last_s = frame.time_s;
  p.next_s = p.from_s + p.pictures / p.rate_hz;
}

nlohmann::json ShortVideo::finish() {
  Parts& p = *parts_;
  p.writer.release();
  if (p.pictures < 2) {
    std::error_code ignored;
    std::filesystem::remove(p.file, ignored);
    return {};
  }
  const double raw = p.raw->rms_px(), still = p.still.rms_px();
  return {{"raw_px", raw},      {"still_px", still}, {"reduction_percent", raw > 0 ? 100 * (1 - still / raw) : 0.0},
          {"from_s", p.from_s}, {"to_s", p.last_s},  {"frames", p.pictures}};
}

}  // namespace heartservo::tools
