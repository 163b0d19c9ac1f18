#include "tracking/frames/visp_grabber.hpp"

#include <visp3/core/vpException.h>
#include <visp3/core/vpFrameGrabber.h>
#include <visp3/core/vpImage.h>

#include <opencv2/imgproc.hpp>
#include <string>

#include "tracking/frames/frame.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tracking {

namespace {

constexpr int MOST_FAILURES = 10;  // in a row; then it is gone

class VispFrames final : public FrameSource {
 public:
  VispFrames(vpFrameGrabber& grabber, VispGrabberOptions options) : grabber_(grabber), options_(std::move(options)) {
    try {
      options_.colour ? grabber_.open(colour_) : grabber_.open(grey_);
    } catch (const vpException& e) {
      throw DeviceError(std::string("the ViSP grabber cannot be opened: ") + e.what());
    }
    size_ = {static_cast<int>(options_.colour ? colour_.getWidth() : grey_.getWidth()),
             static_cast<int>(options_.colour ? colour_.getHeight() : grey_.getHeight())};
  }
  ~VispFrames() override {
    try {
      grabber_.close();
    } catch (const vpException&) {  // nothing is left to do with it
    }
  }

  bool next(Frame& frame) override {
    if ((options_.frame_count > 0 && sequence_ >= options_.frame_count) || (options_.at_end && options_.at_end()))
      return false;
    frame = Frame{};
    frame.sequence = sequence_;
    try {
      options_.colour ? grabber_.acquire(colour_) : grabber_.acquire(grey_);
      failures_ = 0;
    } catch (const vpException& e) {
      frame.note = std::string("the ViSP grabber gave no frame: ") + e.what();
      if (++failures_ >= MOST_FAILURES) throw DeviceError(frame.note);
    }
    frame.time_s = options_.time_s ? options_.time_s() : static_cast<double>(sequence_) / options_.frame_rate_hz;
    ++sequence_;
    if (frame.note.empty()) take(frame);
    if (frame.note.empty() && frame.grey.size() != size_)
      frame.note = "the ViSP grabber's picture has another size than the first";
    if (frame.note.empty()) return true;
    frame.status = FrameStatus::UNREADABLE;
    frame.grey.release();
    frame.colour.release();
    return true;
  }

  cv::Size size() const override { return size_; }
  double frame_rate_hz() const override { return options_.frame_rate_hz; }
  std::optional<std::size_t> frame_count() const override {
    return options_.frame_count > 0 ? std::optional(options_.frame_count) : std::nullopt;
  }
  std::string description() const override { return "a ViSP grabber"; }

 private:
  // The pixels are copied: the vpImage is filled anew for the next frame.
  void take(Frame& frame) {
    if (!options_.colour) {
      cv::Mat(static_cast<int>(grey_.getHeight()), static_cast<int>(grey_.getWidth()), CV_8UC1, grey_.bitmap)
          .copyTo(frame.grey);
      return;
    }
    const cv::Mat rgba(static_cast<int>(colour_.getHeight()), static_cast<int>(colour_.getWidth()), CV_8UC4,
                       colour_.bitmap);
    cv::cvtColor(rgba, frame.colour, cv::COLOR_RGBA2BGR);
    cv::cvtColor(frame.colour, frame.grey, cv::COLOR_BGR2GRAY);
  }

  vpFrameGrabber& grabber_;
  VispGrabberOptions options_;
  vpImage<unsigned char> grey_;
  vpImage<vpRGBa> colour_;
  cv::Size size_;
  std::uint64_t sequence_ = 0;
  int failures_ = 0;
};

}  // namespace

std::unique_ptr<FrameSource> frames_of(vpFrameGrabber& grabber, VispGrabberOptions options) {
  return std::make_unique<VispFrames>(grabber, std::move(options));
}

}  // namespace heartservo::tracking
