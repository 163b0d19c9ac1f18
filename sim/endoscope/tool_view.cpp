#include "sim/endoscope/tool_view.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "sim/endoscope/painted_pattern.hpp"
#include "sim/endoscope/tool_painting.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::sim {
namespace {

constexpr double kNearest_m = 0.008;         // the shaft is drawn up to this distance from the camera
constexpr double kReferenceDepth_m = 0.055;  // light falls off from here

/// Pattern and cover of the marker with a free margin, blurred alike.
std::vector<float> paint_marker() {
  cv::Mat grey(kMarkerTexels, kMarkerTexels, CV_32FC1), cover(kMarkerTexels, kMarkerTexels, CV_32FC1);
  for (int j = 0; j < kMarkerTexels; ++j)
    for (int i = 0; i < kMarkerTexels; ++i) {
      const double x = (i - (kMarkerTexels - 1) / 2.0) / kMarkerScale,
                   y = (j - (kMarkerTexels - 1) / 2.0) / kMarkerScale;
      grey.at<float>(j, i) = static_cast<float>(painted_pattern(kMarkerPattern, x, y));
      // Texels on the outline are covered in part.
      auto inside = [](double c) { return std::clamp((1 - std::abs(c)) * kMarkerScale + 0.5, 0.0, 1.0); };
      cover.at<float>(j, i) = static_cast<float>(inside(x) * inside(y));
    }
  // Half a pixel at 10.8 px per mm on a 4 mm plate.
  constexpr double kBlur = kMarkerScale * 0.023;
  cv::GaussianBlur(grey, grey, {}, kBlur);
  cv::GaussianBlur(cover, cover, {}, kBlur);
  std::vector<float> texels(grey.begin<float>(), grey.end<float>());
  texels.insert(texels.end(), cover.begin<float>(), cover.end<float>());
  return texels;
}

}  // namespace

std::vector<std::string> ToolOptions::validate() const {
  std::vector<std::string> problems;
  if (!(radius_m > 0 && taper_m > 0)) problems.emplace_back("radius_m and taper_m must be positive");
  if (!(direction.allFinite() && direction.norm() > 1e-3)) problems.emplace_back("direction must not be zero");
  if (!(marker_side_m >= 0 && marker_offset_m.allFinite())) problems.emplace_back("marker_side_m must not be negative");
  if (!problems.empty() || marker_side_m == 0) return problems;
  // The marker hides what lies behind it: not the tip, and nothing that would really be before it.
  const double half = marker_side_m / 2;
  if (marker_offset_m.head<2>().cwiseAbs().maxCoeff() < half + 0.0005)
    problems.emplace_back("marker_offset_m lets the marker hide the tip");
  const Eigen::Vector3d d = direction.normalized();
  for (const Eigen::Vector3d& corner : marker_corners(*this, ToolPose(Eigen::Vector3d::Zero()))) {
    const double s = std::max(0.0, corner.head<2>().dot(d.head<2>()) / std::max(1e-9, d.head<2>().squaredNorm()));
    const double front = s * d.z() - radius_m * std::min(1.0, s / taper_m);
    if (corner.z() > front + 1e-9) {
      problems.push_back(
          fmt::format("marker_offset_m puts a corner {:.2g} m behind the shaft's front", corner.z() - front));
      break;
    }
  }
  return problems;
}

std::array<Eigen::Vector3d, 4> marker_corners(const ToolOptions& options, const ToolPose& pose) {
  const double h = options.marker_side_m / 2;
  const auto corner = [&](double x, double y) {
    return Eigen::Vector3d(pose.tip + pose.turn * (options.marker_offset_m + Eigen::Vector3d(x, y, 0)));
  };
  return {corner(-h, -h), corner(h, -h), corner(h, h), corner(-h, h)};
}

ToolView::ToolView(const tracking::Camera& camera, const ToolOptions& options)
    : camera_(camera), options_(options), grid_(camera.width, camera.height), marker_(paint_marker()) {
  const auto problems = options_.validate();
  if (!problems.empty()) throw ConfigError(fmt::format("tool: {}", fmt::join(problems, "; ")));
  direction_ = rest_direction_ = options_.direction.normalized();
  const std::vector<double> rays = node_rays(camera, grid_);
  rays_.assign(rays.begin(), rays.end());
}

void ToolView::place(const ToolPose& pose) {
  tip_ = pose.tip;
  turn_ = pose.turn;
  direction_ = turn_ * rest_direction_;
  left_ = right_ = top_ = bottom_ = 0;
  if (!(tip_.allFinite() && tip_.z() > kNearest_m)) return;
  // Box around circles along the axis. Points far outside the picture, where the distortion model may fold back, are
  // taken as on the edge they lie beyond.
  double low_u = 1e9, high_u = -1e9, low_v = 1e9, high_v = -1e9;
  auto include = [&](const Eigen::Vector3d& p, double radius) {
    if (p.z() < kNearest_m) return;
    const Eigen::Vector2d n(p.x() / p.z(), p.y() / p.z());
    const Eigen::Vector2d straight = camera_.to_pixel(n), pixel = camera_.to_pixel(camera_.distort(n));
    const double margin = 1.3 * radius / p.z() * std::max(camera_.fx, camera_.fy) + 3;
    low_u = std::min({low_u, straight.x() - margin, pixel.x() - margin});
    high_u = std::max({high_u, straight.x() + margin, pixel.x() + margin});
    low_v = std::min({low_v, straight.y() - margin, pixel.y() - margin});
    high_v = std::max({high_v, straight.y() + margin, pixel.y() + margin});
  };
  for (double s = 0; s <= 0.1; s += 0.002)
    include(tip_ + s * direction_, std::min(1.0, s / options_.taper_m) * options_.radius_m);
  if (options_.marker_side_m > 0)
    for (const auto& corner : marker_corners(options_, pose)) include(corner, 0.0005);
  left_ = static_cast<int>(std::clamp(low_u, 0.0, 1.0 * camera_.width));
  right_ = static_cast<int>(std::clamp(high_u + 1, 1.0 * left_, 1.0 * camera_.width));
  top_ = static_cast<int>(std::clamp(low_v, 0.0, 1.0 * camera_.height));
  bottom_ = static_cast<int>(std::clamp(high_v + 1, 1.0 * top_, 1.0 * camera_.height));
}

std::array<int, 2> ToolView::reach(int v) const {
  return v >= top_ && v < bottom_ ? std::array<int, 2>{left_, right_} : std::array<int, 2>{0, 0};
}

void ToolView::paint_row(int v, float* cover, float* grey, float* work) const {
  const auto [first, last] = reach(v);
  if (first == last) return;
  float* rays = work + 2 * grid_.columns();
  grid_.interpolate_row(rays_.data(), 2, v, work, rays);
  const float* x = rays + first;
  const float* y = rays + grid_.padded_width() + first;
  ShaftConstants shaft;
  for (int k = 0; k < 3; ++k)
    shaft.tip[k] = static_cast<float>(tip_(k)), shaft.direction[k] = static_cast<float>(direction_(k));
  shaft.radius = static_cast<float>(options_.radius_m);
  shaft.taper = static_cast<float>(options_.taper_m);
  shaft.nearest = static_cast<float>(kNearest_m);
  shaft.focal_px = static_cast<float>((camera_.fx + camera_.fy) / 2);
  shaft.reference_depth = static_cast<float>(kReferenceDepth_m);
  shaft.brightness = static_cast<float>(options_.brightness);
  shade_shaft(shaft, x, y, last - first, cover, grey);
  if (options_.marker_side_m <= 0) return;
  const Eigen::Vector3d centre = tip_ + turn_ * options_.marker_offset_m;
  if (centre.z() <= kNearest_m) return;
  const double fall_off = std::pow(kReferenceDepth_m / centre.z(), 2);
  const double per_half = 2 / options_.marker_side_m;
  MarkerConstants marker;
  marker.texels = marker_.data();
  marker.light = static_cast<float>(options_.brightness * std::min(fall_off, 1.2));
  for (int k = 0; k < 3; ++k)
    for (int axis = 0; axis < 3; ++axis) marker.axes[axis][k] = static_cast<float>(turn_(k, axis));
  for (int axis = 0; axis < 3; ++axis) marker.centre[axis] = static_cast<float>(turn_.col(axis).dot(centre) * per_half);
  shade_marker(marker, x, y, last - first, cover, grey);
}

void draw_tool(ToolView& view, const ToolPose& pose, cv::Mat& grey, cv::Mat* colour) {
  view.place(pose);
  std::vector<float> cover(static_cast<std::size_t>(grey.cols)), level(cover.size()), work(view.work_size());
  for (int v = 0; v < grey.rows; ++v) {
    const auto [first, last] = view.reach(v);
    if (first == last) continue;
    view.paint_row(v, cover.data(), level.data(), work.data());
    for (int u = first; u < last; ++u) {
      const float c = cover[u - first], l = level[u - first];
      if (c <= 0) continue;
      std::uint8_t& g = grey.at<std::uint8_t>(v, u);
      g = cv::saturate_cast<std::uint8_t>(g + c * (l - g));
      if (colour != nullptr)
        for (int k = 0; k < 3; ++k) {
          std::uint8_t& b = colour->at<cv::Vec3b>(v, u)[k];
          b = cv::saturate_cast<std::uint8_t>(b + c * (l - b));
        }
    }
  }
}

void draw_tool(const tracking::Camera& camera, const ToolOptions& options, const ToolPose& pose, cv::Mat& grey,
               cv::Mat* colour) {
  if (grey.type() != CV_8UC1 || grey.cols != camera.width || grey.rows != camera.height)
    throw ConfigError(fmt::format("draw_tool: picture of {} x {} px for a camera of {} x {}, or not 8-bit grey",
                                  grey.cols, grey.rows, camera.width, camera.height));
  if (colour != nullptr && (colour->type() != CV_8UC3 || colour->size() != grey.size()))
    throw ConfigError("draw_tool: the colour picture must be CV_8UC3 and as large as the grey one");
  ToolView view(camera, options);
  draw_tool(view, pose, grey, colour);
}

}  // namespace heartservo::sim
