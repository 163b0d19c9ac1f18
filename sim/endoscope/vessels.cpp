#include <cmath>
#include <opencv2/imgproc.hpp>

#include "sim/endoscope/tissue_paint.hpp"

namespace heartservo::sim {
namespace {

constexpr int kShift = 4;  // drawing in sixteenths of a texel

struct Vessel {
  cv::Point2d at;      // texels
  double direction;    // rad
  double radius;       // texels
  double length_left;  // texels
};

cv::Point fixed_point(const cv::Point2d& p) { return {cvRound(p.x * (1 << kShift)), cvRound(p.y * (1 << kShift))}; }

/// One vessel down to its end, with its branches. The direction wanders, with memory, about the first one.
void draw(cv::Mat& mask, Vessel v, double texels_per_m, int depth, cv::RNG& random) {
  const double step = 0.4e-3 * texels_per_m, thinnest = 0.07e-3 * texels_per_m;
  const double taper = (v.radius - thinnest) / v.length_left * 0.8;
  const double heading = v.direction;
  double bend = 0, until_branch = random.uniform(4e-3, 9e-3) * texels_per_m;
  for (; v.length_left > 0 && v.radius > thinnest; v.length_left -= step) {
    bend = 0.85 * bend + random.gaussian(0.07) - 0.03 * (v.direction - heading);
    v.direction += bend;
    const cv::Point2d next = v.at + step * cv::Point2d(std::cos(v.direction), std::sin(v.direction));
    cv::line(mask, fixed_point(v.at), fixed_point(next), 255, std::max(1, cvRound(2 * v.radius)), cv::LINE_AA, kShift);
    v.at = next;
    v.radius -= taper * step;
    until_branch -= step;
    if (until_branch < 0 && depth < 4) {
      const double side = random.uniform(0, 2) ? 1 : -1, share = random.uniform(0.45, 0.75);
      draw(mask, {v.at, v.direction + side * random.uniform(0.5, 1.0), v.radius * share, v.length_left * share},
           texels_per_m, depth + 1, random);
      v.direction -= side * 0.15;
      v.radius *= 0.93;
      until_branch = random.uniform(3e-3, 8e-3) * texels_per_m;
    }
  }
}

}  // namespace

cv::Mat paint_vessels(int size, double texels_per_m, double amount, cv::RNG& random) {
  cv::Mat mask = cv::Mat::zeros(size, size, CV_8UC1);
  const int trunks = cvRound(amount * 7 * std::pow(size / texels_per_m / 0.08, 2));
  for (int i = 0; i < trunks; ++i) {
    const cv::Point2d start(random.uniform(0.0, 1.0) * size, random.uniform(0.0, 1.0) * size);
    // Towards the middle, more or less, so that the visible part has its share.
    const double inwards = std::atan2(size / 2.0 - start.y, size / 2.0 - start.x) + random.gaussian(0.6);
    const double radius = random.uniform(0.25e-3, 0.75e-3) * texels_per_m;
    draw(mask, {start, inwards, radius, random.uniform(25e-3, 50e-3) * texels_per_m}, texels_per_m, 0, random);
  }
  cv::Mat vessels;
  mask.convertTo(vessels, CV_32FC1, 1 / 255.0);
  return vessels;
}

}  // namespace heartservo::sim
