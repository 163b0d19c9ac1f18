#pragma once
// What the dense pose knows of a landmark: the grey levels of its plate, as printed or as learnt from a picture.
//
// Plate coordinates: (x, y) in half sides of the plate, x right, y down; its outline is |x|, |y| = 1.
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace heartservo::tracking {

/// A value and its slopes per unit of the plate's coordinates.
struct PlateGrey {
  double value, dx, dy;
};

class LandmarkTemplate {
 public:
  static constexpr int kSize = 256;

  LandmarkTemplate() = default;

  /// From the plate's picture (square, CV_8UC1, 64 px or more; outline to outline), blurred by `blur` (standard
  /// deviation, plate units) as lens and sensor will do it. `blurred`: true when the picture shows it blurred already.
  LandmarkTemplate(const cv::Mat& plate, double blur, bool blurred = false);

  bool empty() const { return planes_.empty(); }
  double blur() const { return blur_; }

  /// True where sample() and what it stands for are free of the plate's surroundings.
  bool covers(double x, double y) const { return x > -reach_ && x < reach_ && y > -reach_ && y < reach_; }
  double reach() const { return reach_; }

  /// Grey level and the change of it if the blur's variance were to double, by cubic convolution (Catmull-Rom), whose
  /// slopes are the derivatives of its values.
  void sample(double x, double y, PlateGrey& grey, PlateGrey& softening) const;

  /// Both in one word a node, row by row, for loops that read many at once: grey in the lower half, softening in the
  /// upper, in units of 1 / kPackedPerGrey (whose rounding is far below that of a picture's grey levels).
  const std::int32_t* packed() const { return packed_.data(); }
  static constexpr int kPackedPerGrey = 64;

  /// Grey levels alone, kSize^2, CV_32FC1: column i lies at x = (2 i + 1) / kSize - 1.
  cv::Mat grey() const;

 private:
  double blur_ = 0, reach_ = 0;
  std::vector<float> planes_;  // kSize^2 pairs of grey and softening
  std::vector<std::int32_t> packed_;
};

}  // namespace heartservo::tracking
