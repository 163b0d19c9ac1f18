#include "tracking/frames/stereo_pair.hpp"

#include <fmt/format.h>

#include "tracking/frames/frame.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tracking {

namespace {

class StereoPair final : public FrameSource {
 public:
  StereoPair(std::unique_ptr<FrameSource> left, std::unique_ptr<FrameSource> right)
      : left_(std::move(left)), right_(std::move(right)) {
    if (left_->size() != right_->size())
      throw InputError(fmt::format("{}: the right view has pictures of {} x {} px, the left one ({}) of {} x {}",
                                   right_->description(), right_->size().width, right_->size().height,
                                   left_->description(), left_->size().width, left_->size().height));
    const auto left_count = left_->frame_count(), right_count = right_->frame_count();
    if (left_count && right_count && *left_count != *right_count)
      throw InputError(fmt::format("{}: the right view has {} frames, the left one ({}) {}; they must be pairs",
                                   right_->description(), *right_count, left_->description(), *left_count));
  }

  bool next(Frame& frame) override {
    const bool there = left_->next(frame);
    if (right_->next(other_) != there)
      throw InputError(fmt::format("{}: the {} view ends after {} frames, before the other; they must be pairs",
                                   right_->description(), there ? "right" : "left", count_));
    if (!there) return false;
    ++count_;
    frame.right = other_.grey;
    if (other_.status != FrameStatus::OK)
      frame.note += fmt::format("{}right view: {}", frame.note.empty() ? "" : "; ", other_.note);
    return true;
  }

  cv::Size size() const override { return left_->size(); }
  double frame_rate_hz() const override { return left_->frame_rate_hz(); }
  std::optional<std::size_t> frame_count() const override { return left_->frame_count(); }
  std::string description() const override { return left_->description(); }

 private:
  std::unique_ptr<FrameSource> left_, right_;
  Frame other_;
  std::size_t count_ = 0;
};

}  // namespace

std::unique_ptr<FrameSource> pair_views(std::unique_ptr<FrameSource> left, std::unique_ptr<FrameSource> right) {
  return std::make_unique<StereoPair>(std::move(left), std::move(right));
}

}  // namespace heartservo::tracking
