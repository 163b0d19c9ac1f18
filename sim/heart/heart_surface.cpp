#include "sim/heart/heart_surface.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <random>

#include "tracking/settings/errors.hpp"

namespace heartservo::sim {
namespace {

constexpr double kTau = 2 * std::numbers::pi;
constexpr int kInPlaneModes = 3;

// The square |p|, |q| <= side / 2 lies inside the 8-norm ball of radius 2^(1/8) side / 2, 1.0906 side / 2.
double inner_radius(double side) { return 0.55 * side; }

/// Orthonormal columns nearest to (da, db): the polar decomposition's rotation.
Eigen::Matrix<double, 3, 2> orthonormal(const Eigen::Vector3d& da, const Eigen::Vector3d& db) {
  Eigen::Matrix<double, 3, 2> E;
  E << da, db;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> gram;
  gram.computeDirect(E.transpose() * E);
  return E * gram.operatorInverseSqrt();
}

Eigen::Matrix<double, 3, 2> tangents(const SurfacePoint& p) {
  return orthonormal({p.xa, p.ya, p.za}, {p.xb, p.yb, p.zb});
}

}  // namespace

std::vector<std::string> HeartSurfaceOptions::validate() const {
  std::vector<std::string> problems;
  if (!(anchor_m.allFinite() && anchor_m.z() > 0.02))
    problems.emplace_back("anchor_m must lie 20 mm or more before the camera");
  if (!(radius_m > 0 && slope_limit > 0 && wavelength_m > 0 && plate_blend_m > 0))
    problems.emplace_back("radius_m, slope_limit, wavelength_m and plate_blend_m must be positive");
  if (!(strain >= 0 && strain <= 0.2 && bulge_m >= 0))
    problems.emplace_back("strain must lie in 0..0.2, bulge_m not below 0");
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    if (!(landmarks[i].side_m > 0)) problems.push_back(fmt::format("landmarks[{}]: side_m must be positive", i));
    for (std::size_t j = 0; j < landmarks.size(); ++j) {
      const double distance = std::hypot(landmarks[i].x_m - landmarks[j].x_m, landmarks[i].y_m - landmarks[j].y_m);
      const double reach = (inner_radius(landmarks[i].side_m) + plate_blend_m) * std::pow(2, 0.375);
      const double needed = reach + landmarks[j].side_m * std::numbers::sqrt2 / 2;
      if (i != j && !(distance > needed))
        problems.push_back(
            fmt::format("landmarks {} and {} are {:.4f} m apart, need {:.4f} m", i, j, distance, needed));
    }
  }
  return problems;
}

HeartSurface::HeartSurface(const HeartSurfaceOptions& options, HeartMotion motion, std::uint64_t seed)
    : options_(options), motion_(std::move(motion)) {
  const auto problems = options_.validate();
  if (!problems.empty()) throw ConfigError(fmt::format("surface: {}", fmt::join(problems, "; ")));
  std::mt19937_64 random(seed ^ 0x5eed5u);
  std::uniform_real_distribution<double> uniform(-0.5, 0.5);
  const double first = uniform(random);
  for (int i = 0; i < kDeformationModes; ++i) {
    const bool in_plane = i < kInPlaneModes;
    // Directions a third of a turn apart, so that the waves together stretch and shear the tissue in every direction.
    const double direction = kTau / 2 * (first + i / 3.0 + 0.15 * uniform(random));
    const double k = kTau / (options_.wavelength_m * (1 + 0.3 * uniform(random)));
    // Part along the wave (stretch), part across (shear).
    const double polarisation = direction + kTau * 0.12 * (1 + uniform(random));
    const double amplitude = in_plane ? 0.62 * options_.strain / k : options_.bulge_m;
    shapes_[i].wave = {k * std::cos(direction), k * std::sin(direction), kTau * uniform(random), {}};
    shapes_[i].wave.d[0] = in_plane ? amplitude * std::cos(polarisation) : 0;
    shapes_[i].wave.d[1] = in_plane ? amplitude * std::sin(polarisation) : 0;
    shapes_[i].wave.d[2] = in_plane ? 0 : amplitude;
    shapes_[i].lag = uniform(random);
    shapes_[i].second_lag = uniform(random);
  }
}

void HeartSurface::at(double t, SurfaceState& state) const {
  const double rs = options_.radius_m * options_.slope_limit;
  state.tissue.sag_scale = rs * options_.slope_limit;
  state.tissue.inverse_rs2 = 1 / (rs * rs);
  const double phase = motion_.cardiac_phase(t), strength = motion_.beat_strength(t);
  for (int i = 0; i < kDeformationModes; ++i) {
    const ModeShape& shape = shapes_[i];
    const double beat =
        strength * (std::cos(kTau * (phase + shape.lag)) + 0.3 * std::cos(kTau * (2 * phase + shape.second_lag))) / 1.3;
    state.tissue.modes[i] = shape.wave;
    for (double& d : state.tissue.modes[i].d) d *= beat;
  }
  state.R_camera_local = motion_.rotation(t);
  state.t_camera_local = options_.anchor_m + motion_.displacement(t);
  state.plates.resize(options_.landmarks.size());
  for (std::size_t i = 0; i < state.plates.size(); ++i) {
    const LandmarkOptions& landmark = options_.landmarks[i];
    Plate& plate = state.plates[i];
    plate.a = landmark.x_m, plate.b = landmark.y_m;
    plate.cosine = std::cos(landmark.angle_rad), plate.sine = std::sin(landmark.angle_rad);
    plate.inner = inner_radius(landmark.side_m), plate.blend = options_.plate_blend_m;
    // The plate rides on the tissue that would be under its centre.
    const SurfacePoint centre = tissue_point(state.tissue, plate.a, plate.b);
    const auto E = tangents(centre);
    const double c[3] = {centre.x, centre.y, centre.z};
    for (int k = 0; k < 3; ++k) {
      plate.c[k] = c[k];
      plate.e1[k] = plate.cosine * E(k, 0) + plate.sine * E(k, 1);
      plate.e2[k] = plate.cosine * E(k, 1) - plate.sine * E(k, 0);
    }
  }
}

SurfaceState HeartSurface::at(double t) const {
  SurfaceState state;
  at(t, state);
  return state;
}

Eigen::Isometry3d HeartSurface::T_camera_point(double a, double b, double t) const {
  const SurfaceState state = at(t);
  const auto E = tangents(surface_point(state, a, b));
  Eigen::Matrix3d R_local_point;
  R_local_point << E, E.col(0).cross(E.col(1));
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = state.R_camera_local * R_local_point;
  T.translation() = state.point(a, b);
  return T;
}

Eigen::Isometry3d HeartSurface::T_camera_landmark(std::size_t i, double t) const {
  const LandmarkOptions& landmark = options_.landmarks.at(i);
  return T_camera_point(landmark.x_m, landmark.y_m, t) *
         Eigen::AngleAxisd(landmark.angle_rad, Eigen::Vector3d::UnitZ());
}

std::array<Eigen::Vector3d, 4> HeartSurface::landmark_corners(std::size_t i, double t) const {
  const Eigen::Isometry3d T = T_camera_landmark(i, t);
  const double h = options_.landmarks.at(i).side_m / 2;
  return {T * Eigen::Vector3d(-h, -h, 0), T * Eigen::Vector3d(h, -h, 0), T * Eigen::Vector3d(h, h, 0),
          T * Eigen::Vector3d(-h, h, 0)};
}

}  // namespace heartservo::sim
