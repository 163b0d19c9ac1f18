#include "servo/control/surgeon_path.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace heartservo::servo {

namespace {

constexpr double kTau = 2 * std::numbers::pi;

// The circle is entered along a spiral, so that the hand begins at rest.
Eigen::Vector3d circle(double turns, double radius) {
  const double x = std::min(turns, 1.0), grown = radius * x * x * (3 - 2 * x);
  return {grown * std::sin(kTau * turns), -grown * std::cos(kTau * turns), 0};
}

// Over the vessel and back, into the tissue on either side; at rest between stitches.
Eigen::Vector3d suture(double stitch, const PathOptions& o) {
  const double s = std::min(stitch, static_cast<double>(o.stitches));
  return {o.pitch_m * (s - std::sin(kTau * s) / kTau), o.size_m * (1 - std::cos(kTau * s)) / 2,
          o.depth_m * (1 - std::cos(2 * kTau * s)) / 2};
}

}  // namespace

std::vector<std::string> PathOptions::validate() const {
  std::vector<std::string> problems;
  if (type == "file" && file.empty()) problems.emplace_back("loop.path.type is file, but loop.path.file is empty");
  if (type != "file" && !file.empty()) problems.emplace_back("loop.path.file is given, but loop.path.type is not file");
  return problems;
}

SurgeonPath::SurgeonPath(const PathOptions& options, std::vector<PathPoint> recorded)
    : options_(options), recorded_(std::move(recorded)) {
  for (const auto& point : recorded_) reach_ = std::max(reach_, (point.position - recorded_.front().position).norm());
  const double length = options_.period_s * (options_.type == "suture" ? options_.stitches : 2);
  for (int i = 0; i <= 400 && options_.type != "file"; ++i)
    reach_ = std::max(reach_, position(options_.start_s + length * i / 400).norm());
}

Eigen::Vector3d SurgeonPath::position(double time_s) const {
  const double t = std::max(0.0, time_s - options_.start_s);
  if (options_.type == "circle") return circle(t / options_.period_s, options_.size_m);
  if (options_.type == "suture") return suture(t / options_.period_s, options_);
  if (options_.type == "file" && !recorded_.empty())
    return recorded_at(recorded_.front().time_s + t) - recorded_.front().position;
  return Eigen::Vector3d::Zero();
}

Eigen::Vector3d SurgeonPath::velocity(double time_s) const {
  constexpr double kHalf_s = 1e-3;
  return (position(time_s + kHalf_s) - position(time_s - kHalf_s)) / (2 * kHalf_s);
}

Eigen::Vector3d SurgeonPath::tangent(std::size_t i) const {
  if (i == 0 || i + 1 >= recorded_.size()) return Eigen::Vector3d::Zero();
  return (recorded_[i + 1].position - recorded_[i - 1].position) / (recorded_[i + 1].time_s - recorded_[i - 1].time_s);
}

Eigen::Vector3d SurgeonPath::recorded_at(double time_s) const {
  if (time_s >= recorded_.back().time_s) return recorded_.back().position;
  const auto after = std::upper_bound(recorded_.begin(), recorded_.end(), time_s,
                                      [](double t, const PathPoint& p) { return t < p.time_s; });
  const auto i = static_cast<std::size_t>(after - recorded_.begin()) - 1;
  const PathPoint &a = recorded_[i], &b = recorded_[i + 1];
  const double h = b.time_s - a.time_s, x = (time_s - a.time_s) / h, y = 1 - x;
  return (1 + 2 * x) * y * y * a.position + x * y * y * h * tangent(i) + x * x * (3 - 2 * x) * b.position -
         x * x * y * h * tangent(i + 1);
}

}  // namespace heartservo::servo
