#pragma once
// A source whose first frame has been looked at before it is handed on.
#include <memory>

#include "tracking/frames/frame.hpp"
#include "tracking/frames/frame_source.hpp"

namespace heartservo::tracking {

class PeekedSource final : public FrameSource {
 public:
  explicit PeekedSource(std::unique_ptr<FrameSource> source) : source_(std::move(source)) {}

  /// The first frame; null where there is none. Before the first next().
  const Frame* first() {
    if (!peeked_) there_ = source_->next(first_), peeked_ = true;
    return there_ ? &first_ : nullptr;
  }

  bool next(Frame& frame) override {
    if (!there_) return source_->next(frame);
    frame = std::move(first_);
    there_ = false;
    return true;
  }
  cv::Size size() const override { return source_->size(); }
  double frame_rate_hz() const override { return source_->frame_rate_hz(); }
  std::optional<std::size_t> frame_count() const override { return source_->frame_count(); }
  std::string description() const override { return source_->description(); }
  LiveSource* live() override { return source_->live(); }

 private:
  std::unique_ptr<FrameSource> source_;
  Frame first_;
  bool peeked_ = false, there_ = false;
};

}  // namespace heartservo::tracking
