#pragma once
// What is watched from frame to frame: the driver's count, and whether the picture changes.
#include <cstdint>
#include <cstring>
#include <opencv2/core/mat.hpp>

namespace heartservo::tracking::v4l2 {

/// The driver's count of frames; it is 32 bits, may begin anywhere and may wrap.
class SequenceWatch {
 public:
  struct Verdict {
    std::uint32_t missing = 0;  ///< frames between the last and this one
    bool restarted = false;     ///< the count went back or stood still
  };
  /// `step`: by how much frames count (fields of one frame may share a number: 0 is no fault then).
  Verdict check(std::uint32_t sequence, bool may_repeat) {
    Verdict verdict;
    const auto ahead = static_cast<std::int32_t>(sequence - last_);
    if (started_ && ahead > 0)
      verdict.missing = static_cast<std::uint32_t>(ahead) - 1;
    else if (started_)
      verdict.restarted = ahead < 0 || !may_repeat;
    started_ = true;
    last_ = sequence;
    return verdict;
  }
  void restart() { started_ = false; }
  std::uint32_t last() const { return last_; }

 private:
  bool started_ = false;
  std::uint32_t last_ = 0;
};

/// Since when the picture is the same, byte by byte. A camera's noise changes every picture.
class FreezeWatch {
 public:
  /// How long the picture has been the same, in s; 0 for one that differs from the one before.
  double same_for(const cv::Mat& picture, double time_s) {
    const std::uint64_t hash = hash_of(picture);
    if (!started_ || hash != last_) since_s_ = time_s;
    started_ = true;
    last_ = hash;
    return time_s - since_s_;
  }
  void restart() { started_ = false; }

 private:
  // FNV-1a over words of 8 bytes: every byte counts.
  static std::uint64_t hash_of(const cv::Mat& picture) {
    std::uint64_t hash = 14695981039346656037u;
    const std::size_t bytes = static_cast<std::size_t>(picture.cols) * picture.elemSize();
    for (int row = 0; row < picture.rows; ++row) {
      const std::uint8_t* line = picture.ptr(row);
      std::size_t i = 0;
      for (std::uint64_t word; i + sizeof word <= bytes; i += sizeof word) {
        std::memcpy(&word, line + i, sizeof word);
        hash = (hash ^ word) * 1099511628211u;
        hash ^= hash >> 29;
      }
      for (; i < bytes; ++i) hash = (hash ^ line[i]) * 1099511628211u;
    }
    return hash;
  }

  bool started_ = false;
  std::uint64_t last_ = 0;
  double since_s_ = 0;
};

}  // namespace heartservo::tracking::v4l2
