// The picture agrees with the ground truth: what lies at a surface point appears where the camera projects that point.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>

#include "sim/endoscope/endoscope.hpp"
#include "tests/sim/scene_support.hpp"
#include "tests/support/random.hpp"

namespace heartservo::sim {
namespace {

using test::inside;
using test::paper_camera;

HeartSurface surface_with_landmarks() {
  HeartSurfaceOptions options;
  options.landmarks = {{.x_m = 0.001, .y_m = -0.002, .side_m = 0.005, .angle_rad = 0.2},
                       {.x_m = -0.014, .y_m = 0.004, .side_m = 0.005, .angle_rad = -0.5}};
  return HeartSurface(options, HeartMotion({}, 3, 20), 4);
}

PictureOptions plain() {
  PictureOptions options;
  options.light = "flat";
  options.noise_grey = options.bias_grey = 0;
  return options;
}

const std::vector<double> kTimes{0.0, 0.31, 1.77, 4.4, 9.13};

TEST(PictureGeometry, RaysMeetTheSurfaceWithinFiveThousandthsOfAPixel) {
  const tracking::Camera camera = paper_camera();
  const HeartSurface surface = surface_with_landmarks();
  SurfaceNodes nodes(camera, plain(), 1.0);  // one texel per metre: texture coordinates are material coordinates
  const NodeGrid& grid = nodes.grid();
  std::vector<float> scratch(grid.columns()),
      row(static_cast<std::size_t>(SurfaceNodes::kChannels) * grid.padded_width());
  double worst = 0;
  for (const double t : kTimes) {
    const SurfaceState state = surface.at(t);
    nodes.solve(state, 0, grid.size());
    for (int v = 0; v < camera.height; v += 3) {
      grid.interpolate_row(nodes.planes(), SurfaceNodes::kChannels, v, scratch.data(), row.data());
      for (int u = v % 5; u < camera.width; u += 5) {
        const Eigen::Vector2d pixel =
            camera.project(state.point(row[u], row[SurfaceNodes::kTexelY * grid.padded_width() + u]));
        worst = std::max(worst, (pixel - Eigen::Vector2d(u, v)).norm());
      }
    }
  }
  RecordProperty("worst_px", std::to_string(worst));
  EXPECT_LT(worst, 0.005);
}

/// The material point that pixel (u, v) sees, by Newton's method on the ground truth from a point near by.
Eigen::Vector2d seen_material(const tracking::Camera& camera, const SurfaceState& state, int u, int v,
                              Eigen::Vector2d ab) {
  const Eigen::Vector2d ray = camera.normalise({u, v});
  for (int step = 0; step < 4; ++step) {
    const double h = 1e-6;
    const auto miss = [&](double a, double b) -> Eigen::Vector2d {
      const Eigen::Vector3d p = state.point(a, b);
      return p.head<2>() - ray * p.z();
    };
    const Eigen::Vector2d f = miss(ab.x(), ab.y());
    Eigen::Matrix2d J;
    J << (miss(ab.x() + h, ab.y()) - f) / h, (miss(ab.x(), ab.y() + h) - f) / h;
    ab -= J.inverse() * f;
  }
  return ab;
}

/// Where the dot's centroid should be. Around a plate the tissue bends so much that it is not the image of the dot's
/// centre; it follows from the dot as the ground truth itself draws it, pixel by pixel.
Eigen::Vector2d expected_centre(const tracking::Camera& camera, const SurfaceState& state, const Eigen::Vector2d& dot) {
  const Eigen::Vector2d truth = camera.project(state.point(dot.x(), dot.y()));
  const int u0 = static_cast<int>(truth.x()) - 8, v0 = static_cast<int>(truth.y()) - 8;
  Eigen::Matrix<double, 18, 18> exact;
  for (int v = 0; v < 18; ++v)
    for (int u = 0; u < 18; ++u) {
      const double distance2 = (seen_material(camera, state, u0 + u, v0 + v, dot) - dot).squaredNorm();
      exact(v, u) = 200 * std::exp(-distance2 / (2 * test::kDotSigma_m * test::kDotSigma_m));
    }
  return test::dot_centre([&](int u, int v) { return exact(v - v0, u - u0); }, truth);
}

TEST(PictureGeometry, DotsOnTheTissueAppearWhereTheirPointsProject) {
  const tracking::Camera camera = paper_camera();
  const HeartSurface surface = surface_with_landmarks();
  const auto& landmarks = surface.options().landmarks;
  auto random = test::seeded();
  std::vector<Eigen::Vector2d> dots;
  for (int j = -9; j <= 9; ++j)
    for (int i = -9; i <= 9; ++i)
      dots.emplace_back(0.004 * i + test::uniform(random, -8e-4, 8e-4), 0.004 * j + test::uniform(random, -8e-4, 8e-4));
  Endoscope endoscope(camera, surface, plain(), 1, {}, test::dot_texture(dots));
  cv::Mat grey;
  double worst = 0, worst_far = 0;
  int measured = 0, measured_far = 0;
  for (const double t : {0.31, 1.77, 9.13}) {
    endoscope.render(t, 0, grey);
    const SurfaceState state = surface.at(t);
    for (const auto& dot : dots) {
      const Eigen::Vector2d truth = camera.project(state.point(dot.x(), dot.y()));
      if (!inside(camera, truth, 11)) continue;
      const Eigen::Vector2d centre = test::dot_centre(grey, truth);
      worst = std::max(worst, (centre - expected_centre(camera, state, dot)).norm()), ++measured;
      if (std::all_of(landmarks.begin(), landmarks.end(),
                      [&](const auto& l) { return std::hypot(dot.x() - l.x_m, dot.y() - l.y_m) > 0.009; }))
        worst_far = std::max(worst_far, (centre - truth).norm()), ++measured_far;
    }
  }
  RecordProperty("worst_px", std::to_string(worst));
  RecordProperty("worst_far_px", std::to_string(worst_far));
  EXPECT_GT(measured, 500);
  EXPECT_GT(measured_far, 250);
  EXPECT_LT(worst, 0.02);
  EXPECT_LT(worst_far, 0.02);
}

TEST(PictureGeometry, DotsOnAPlateAppearWhereTheRigidPlateProjects) {
  const tracking::Camera camera = paper_camera();
  const HeartSurface surface = surface_with_landmarks();
  std::vector<Eigen::Vector2d> on_plate, dots;
  for (const double q : {-0.0018, 0.0, 0.0018})
    for (const double p : {-0.0018, 0.0, 0.0018}) on_plate.emplace_back(p, q);
  for (const auto& landmark : surface.options().landmarks)
    for (const auto& p : on_plate)
      dots.push_back(Eigen::Vector2d(landmark.x_m, landmark.y_m) + Eigen::Rotation2Dd(landmark.angle_rad) * p);
  Endoscope endoscope(camera, surface, plain(), 1, {}, test::dot_texture(dots));
  cv::Mat grey;
  double worst = 0;
  for (const double t : kTimes) {
    endoscope.render(t, 0, grey);
    for (std::size_t i = 0; i < surface.landmark_count(); ++i)
      for (const auto& p : on_plate) {
        const Eigen::Vector2d truth =
            camera.project(surface.T_camera_landmark(i, t) * Eigen::Vector3d(p.x(), p.y(), 0));
        worst = std::max(worst, (test::dot_centre(grey, truth) - truth).norm());
      }
  }
  RecordProperty("worst_px", std::to_string(worst));
  EXPECT_LT(worst, 0.02);
}

}  // namespace
}  // namespace heartservo::sim
