#include "tracking/landmark/landmark_template.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace heartservo::tracking {

namespace {

constexpr double kClear = 3.5;     // standard deviations of the blur from the outline on which the tissue's grey spreads
constexpr double kNarrowest = 1.0; // nodes; a sharper picture would be more than cubic polynomials between nodes can be

cv::Mat blurred_by(const cv::Mat& sharp, double sigma_nodes) {
  cv::Mat result;
  const int side = 2 * static_cast<int>(std::ceil(4 * sigma_nodes)) + 1;
  cv::GaussianBlur(sharp, result, {side, side}, sigma_nodes, sigma_nodes, cv::BORDER_REPLICATE);
  return result;
}

/// Catmull-Rom weights of the nodes -1, 0, 1, 2 at the fraction f, and their derivatives.
struct Weights {
  double w[4], d[4];
  explicit Weights(double f) {
    const double f2 = f * f, f3 = f2 * f;
    w[0] = 0.5 * (-f + 2 * f2 - f3), d[0] = 0.5 * (-1 + 4 * f - 3 * f2);
    w[1] = 0.5 * (2 - 5 * f2 + 3 * f3), d[1] = 0.5 * (-10 * f + 9 * f2);
    w[2] = 0.5 * (f + 4 * f2 - 3 * f3), d[2] = 0.5 * (1 + 8 * f - 9 * f2);
    w[3] = 0.5 * (-f2 + f3), d[3] = 0.5 * (-2 * f + 3 * f2);
  }
};

}  // namespace

LandmarkTemplate::LandmarkTemplate(const cv::Mat& plate, double blur, bool blurred)
    : blur_(blur), planes_(2 * static_cast<std::size_t>(kSize) * kSize) {
  cv::Mat sharp, nodes;
  plate.convertTo(sharp, CV_32F);
  // The mean over each node's cell: of 1 / sqrt(12) nodes' standard deviation, which the blur below takes into account.
  cv::resize(sharp, nodes, {kSize, kSize}, 0, 0, plate.cols > kSize ? cv::INTER_AREA : cv::INTER_CUBIC);
  const double cell2 = plate.cols > kSize ? 1.0 / 12 : 0;
  const double wanted = std::max(kNarrowest, blur * kSize / 2);
  const cv::Mat grey = blurred ? nodes : blurred_by(nodes, std::sqrt(wanted * wanted - cell2));
  const cv::Mat softer = blurred ? blurred_by(nodes, wanted)
                                 : blurred_by(nodes, std::sqrt(2 * wanted * wanted - cell2));
  for (int j = 0; j < kSize; ++j)
    for (int i = 0; i < kSize; ++i) {
      float* node = &planes_[2 * (static_cast<std::size_t>(j) * kSize + i)];
      node[0] = grey.at<float>(j, i);
      node[1] = softer.at<float>(j, i) - node[0];
      const auto word = [](float v) { return static_cast<std::uint32_t>(std::lround(v * kPackedPerGrey)) & 0xffffU; };
      packed_.push_back(static_cast<std::int32_t>(word(node[1]) << 16 | word(node[0])));
    }
  reach_ = 1 - std::max(kClear * std::sqrt(2) * blur, 6.0 / kSize);
}

void LandmarkTemplate::sample(double x, double y, PlateGrey& grey, PlateGrey& softening) const {
  constexpr double kScale = 0.5 * kSize;
  const double s = (x + 1) * kScale - 0.5, t = (y + 1) * kScale - 0.5;
  const int i = std::clamp(static_cast<int>(s), 1, kSize - 3), j = std::clamp(static_cast<int>(t), 1, kSize - 3);
  const Weights across(s - i), down(t - j);
  double v[2] = {}, vx[2] = {}, vy[2] = {};
  for (int row = 0; row < 4; ++row) {
    const float* node = &planes_[2 * (static_cast<std::size_t>(j + row - 1) * kSize + i - 1)];
    for (int k = 0; k < 2; ++k) {
      const double a = node[k], b = node[2 + k], c = node[4 + k], e = node[6 + k];
      const double along = across.w[0] * a + across.w[1] * b + across.w[2] * c + across.w[3] * e;
      v[k] += down.w[row] * along;
      vy[k] += down.d[row] * along;
      vx[k] += down.w[row] * (across.d[0] * a + across.d[1] * b + across.d[2] * c + across.d[3] * e);
    }
  }
  grey = {v[0], vx[0] * kScale, vy[0] * kScale};
  softening = {v[1], vx[1] * kScale, vy[1] * kScale};
}

cv::Mat LandmarkTemplate::grey() const {
  cv::Mat result(kSize, kSize, CV_32FC1);
  for (int k = 0; k < kSize * kSize; ++k) result.at<float>(k / kSize, k % kSize) = planes_[2 * k];
  return result;
}

}  // namespace heartservo::tracking
