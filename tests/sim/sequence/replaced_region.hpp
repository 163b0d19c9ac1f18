#pragma once
// A sequence whose region is gone for a while: noise, plain grey or other tissue is in its place, moving just as it
// did, under the same light. The rest of the picture goes on. Truth as in the sequence itself.
#include <opencv2/imgproc.hpp>
#include <random>
#include <string>
#include <vector>

#include "sim/sequence/artificial_sequence.hpp"
#include "tracking/frames/frame.hpp"

namespace heartservo::test {

/// What can be in the region's place: "noise" (white, new in every frame), "grey", or a texture of the base pictures
/// (drawn from another seed: other tissue, of the same kind where the name is the sequence's own).
inline std::vector<std::string> replacements() {
  std::vector<std::string> names = sim::base_picture_names();
  names.insert(names.begin(), {"noise", "grey"});
  return names;
}

/// All frames of a sequence in which the whole picture moves, there and back again for ever.
class FrameLoop {
 public:
  explicit FrameLoop(const sim::SequenceOptions& options, std::shared_ptr<const sim::BasePicture> base = nullptr)
      : options_(options), sequence_(std::make_unique<sim::ArtificialSequence>(options, std::move(base))) {
    for (tracking::Frame frame; sequence_->next(frame);) frames_.push_back(frame);
  }
  std::size_t phase(std::size_t k) const {
    const std::size_t period = 2 * frames_.size() - 2, at = k % period;
    return at < frames_.size() ? at : period - at;
  }
  const cv::Mat& grey(std::size_t k) const { return frames_[phase(k)].grey; }
  /// How the first frame's pixels have moved.
  Eigen::Matrix3d H(std::size_t k) const { return sequence_->H_current_reference(phase(k)); }
  /// Of the given side, about the sequence's place.
  tracking::Quad region(int side_px) const {
    const Eigen::Vector2d middle = sim::place_px(options_.place, sequence_->size());
    const double half = std::floor(side_px / 2.0);
    return tracking::rectangle(middle.x() - half, middle.y() - half, side_px, side_px);
  }

 private:
  sim::SequenceOptions options_;
  std::unique_ptr<sim::ArtificialSequence> sequence_;
  std::vector<tracking::Frame> frames_;
};

class ReplacedRegion {
 public:
  /// `loop`: the sequence's frames, `other`: those of other tissue in the same motion (unused for noise and grey).
  ReplacedRegion(const FrameLoop& loop, int side_px, std::string replacement, const FrameLoop* other,
                 std::uint64_t seed)
      : loop_(loop), side_px_(side_px), replacement_(std::move(replacement)), other_(other), random_(seed) {}

  tracking::Quad region() const { return loop_.region(side_px_); }
  tracking::Quad corners(std::size_t k) const { return tracking::transform(loop_.H(k), region()); }

  tracking::Frame frame(std::size_t k, bool replaced) {
    tracking::Frame frame;
    frame.sequence = k;
    frame.time_s = 0.008 * static_cast<double>(k);
    frame.grey = loop_.grey(k);
    if (replaced) {
      frame.grey = frame.grey.clone();
      replace(frame.grey, k);
    }
    return frame;
  }

 private:
  static constexpr double kRim = 1.25;  // of the region's side: nothing of its surroundings either

  void replace(cv::Mat& grey, std::size_t k) {
    const tracking::Quad truth = corners(k);
    const Eigen::Vector2d middle = tracking::centre(truth);
    std::vector<cv::Point> outline;
    for (const auto& c : truth) {
      const Eigen::Vector2d p = middle + kRim * (c - middle);
      outline.emplace_back(cvRound(p.x()), cvRound(p.y()));
    }
    cv::Mat mask = cv::Mat::zeros(grey.size(), CV_8UC1);
    cv::fillConvexPoly(mask, outline, 255);
    const cv::Rect box = cv::boundingRect(outline) & cv::Rect(0, 0, grey.cols, grey.rows);
    if (replacement_ == "grey") {
      grey.setTo(cv::mean(grey, mask), mask);
    } else if (replacement_ == "noise") {
      cv::Mat noise(box.size(), CV_8UC1);
      std::uniform_int_distribution<int> level(0, 255);
      for (auto& v : cv::Mat_<std::uint8_t>(noise)) v = static_cast<std::uint8_t>(level(random_));
      noise.copyTo(grey(box), mask(box));
    } else {
      other_->grey(k).copyTo(grey, mask);
    }
  }

  const FrameLoop& loop_;
  int side_px_;
  std::string replacement_;
  const FrameLoop* other_;
  std::mt19937_64 random_;
};

}  // namespace heartservo::test
