#include "sim/sequence/planar_motion.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <cmath>

#include "tracking/settings/errors.hpp"
#include "tracking/settings/yaml_reader.hpp"

namespace heartservo::sim {

namespace {

constexpr double kDegree = M_PI / 180;

double turn(double t, double period) { return 2 * M_PI * t / period; }
double wave(double t, double period) { return std::sin(turn(t, period)); }

PlanarView view_a(double t) {
  PlanarView view;
  view.shift_px.x() = 40 * wave(t, 100);
  return view;
}

PlanarView view_b(double t) {
  PlanarView view;
  view.shift_px = {30 * (std::cos(turn(t, 100)) - 1), 30 * wave(t, 100)};
  view.angle_rad = 20 * kDegree * wave(t, 80);
  view.scale = 1 + 0.10 * wave(t, 67);
  view.perspective = {2e-4 * wave(t, 90), 1.5e-4 * wave(t, 60)};
  return view;
}

PlanarView view_d(double t) {
  PlanarView view;
  view.shift_px = {60 * wave(t, 27), 25 * wave(t, 41)};
  view.angle_rad = 8 * kDegree * wave(t, 33);
  return view;
}

PlanarView view_cde(double t) {
  PlanarView view = view_b(t);
  const PlanarView d = view_d(t);
  view.shift_px += d.shift_px;
  view.angle_rad += d.angle_rad;
  return view;
}

PlanarView view_fast(double t) {
  PlanarView view;
  view.shift_px = {75 * wave(t, 27), 55 * wave(t, 19)};
  view.angle_rad = 8 * kDegree * wave(t, 33);
  return view;
}

PlanarView view_table5(double t) {
  PlanarView view;
  view.shift_px.y() = 20 * wave(t, 50);
  return view;
}

PlanarView view_circle(double t) {
  PlanarView view;
  view.shift_px = {40 * (std::cos(turn(t, 100)) - 1), 40 * wave(t, 100)};
  view.angle_rad = 30 * kDegree * wave(t, 80);
  view.scale = 1 + 0.10 * wave(t, 67);
  return view;
}

std::vector<SequenceKind> make_kinds() {
  const auto whole = [](const char* name, const char* summary, PlanarView (*view)(double)) {
    SequenceKind kind;
    kind.name = name;
    kind.summary = summary;
    kind.view = view;
    return kind;
  };
  const auto glare = [](SequenceKind kind) {
    kind.speculars = 16;
    kind.noise_grey = 4;
    return kind;
  };
  const auto light = [](SequenceKind kind) {
    kind.gain = 0.25;
    kind.bias_grey = 15;
    return kind;
  };
  const auto patch = [](SequenceKind kind, int frames, int speculars) {
    kind.patch = true;
    kind.noise_grey = 0;
    kind.frames = frames;
    kind.frame_rate_hz = 100;
    kind.speculars = speculars;
    return kind;
  };
  return {
      whole("a", "40 px to and fro", view_a),
      whole("b", "circle of 30 px radius, rotation, scale, perspective", view_b),
      glare(whole("c", "b with moving saturated blobs and noise of 4 grey levels", view_b)),
      whole("d", "14 px per frame, with rotation", view_d),
      light(whole("e", "b with changing gain and bias", view_b)),
      light(glare(whole("cde", "c, d and e at once", view_cde))),
      whole("fast", "25 px per frame, with rotation", view_fast),
      patch(whole("table5", "a patch over a heart sequence, 20 px up and down, 2.5 px per frame", view_table5), 100, 0),
      patch(whole("circle", "a patch over a heart sequence on a circle, rotation, scale, blobs", view_circle), 151, 16),
  };
}

}  // namespace

const std::vector<SequenceKind>& sequence_kinds() {
  static const std::vector<SequenceKind> kinds = make_kinds();
  return kinds;
}

const SequenceKind& sequence_kind(const std::string& name) {
  std::vector<std::string> names;
  for (const auto& kind : sequence_kinds()) {
    if (kind.name == name) return kind;
    names.push_back(kind.name);
  }
  throw ConfigError(fmt::format("artificial sequence '{}' is not known{}; choose one of {}", name,
                                did_you_mean(name, names), fmt::join(names, ", ")));
}

Eigen::Matrix3d homography_of(const PlanarView& view, const Eigen::Vector2d& centre_px) {
  Eigen::Matrix3d away = Eigen::Matrix3d::Identity(), back = Eigen::Matrix3d::Identity(),
                  middle = Eigen::Matrix3d::Identity();
  away.topRightCorner<2, 1>() = -centre_px;
  back.topRightCorner<2, 1>() = centre_px + view.shift_px;
  middle.topLeftCorner<2, 2>() = view.scale * Eigen::Rotation2Dd(view.angle_rad).toRotationMatrix();
  middle.bottomLeftCorner<1, 2>() = view.perspective.transpose();
  const Eigen::Matrix3d H = back * middle * away;
  return H / H(2, 2);
}

}  // namespace heartservo::sim
