#include "sim/endoscope/surface_nodes.hpp"

#include <algorithm>
#include <cmath>

#include "tracking/settings/target_clones.hpp"

namespace heartservo::sim {
namespace {

constexpr int kBatch = 64;       // nodes worked on together; everything stays in the first-level cache
constexpr int kNewtonSteps = 4;  // from the tangent plane to far below a micrometre; the picture tests would tell

/// A batch of rays in the surface's local frame, origin + s (mx, my, 1), and the surface's points on them.
struct Batch {
  int count;
  double origin[3];
  double mx[kBatch], my[kBatch];
  double a[kBatch], b[kBatch];
  double x[kBatch], y[kBatch], z[kBatch];
  double xa[kBatch], ya[kBatch], za[kBatch];
  double xb[kBatch], yb[kBatch], zb[kBatch];
};

HEARTSERVO_INLINE void store(const SurfacePoint& p, int i, Batch& n) {
  n.x[i] = p.x, n.y[i] = p.y, n.z[i] = p.z;
  n.xa[i] = p.xa, n.ya[i] = p.ya, n.za[i] = p.za;
  n.xb[i] = p.xb, n.yb[i] = p.yb, n.zb[i] = p.zb;
}

/// Rays into the local frame (R: rows of R_camera_local); first guess: where they meet the plane z = 0.
HEARTSERVO_SIMD
void enter_rays(const double* rx, const double* ry, const double* R, Batch& n) {
  const double r[9] = {R[0], R[1], R[2], R[3], R[4], R[5], R[6], R[7], R[8]};
  const double ox = n.origin[0], oy = n.origin[1], oz = n.origin[2];
  for (int i = 0; i < n.count; ++i) {
    const double dx = r[0] * rx[i] + r[3] * ry[i] + r[6];
    const double dy = r[1] * rx[i] + r[4] * ry[i] + r[7];
    const double dz = r[2] * rx[i] + r[5] * ry[i] + r[8];
    n.mx[i] = dx / dz, n.my[i] = dy / dz;
    n.a[i] = ox - oz * n.mx[i];
    n.b[i] = oy - oz * n.my[i];
  }
}

HEARTSERVO_SIMD
void evaluate_tissue(const Tissue& tissue, Batch& n) {
  const Tissue t = tissue;
  for (int i = 0; i < n.count; ++i) store(tissue_point(t, n.a[i], n.b[i]), i, n);
}

HEARTSERVO_SIMD
void evaluate_plate(const Plate& plate, Batch& n) {
  const Plate laid = plate;
  for (int i = 0; i < n.count; ++i) {
    SurfacePoint p{n.x[i], n.y[i], n.z[i], n.xa[i], n.ya[i], n.za[i], n.xb[i], n.yb[i], n.zb[i]};
    lay_plate(laid, n.a[i], n.b[i], p);
    store(p, i, n);
  }
}

/// One step of Newton's method on "the surface's point lies on the ray", two equations in (a, b).
HEARTSERVO_SIMD
void newton_step(Batch& n) {
  const double ox = n.origin[0], oy = n.origin[1], oz = n.origin[2];
  for (int i = 0; i < n.count; ++i) {
    const double mx = n.mx[i], my = n.my[i];
    const double f = n.x[i] - ox - mx * (n.z[i] - oz), g = n.y[i] - oy - my * (n.z[i] - oz);
    const double fa = n.xa[i] - mx * n.za[i], fb = n.xb[i] - mx * n.zb[i];
    const double ga = n.ya[i] - my * n.za[i], gb = n.yb[i] - my * n.zb[i];
    const double determinant = fa * gb - fb * ga;
    n.a[i] -= (gb * f - fb * g) / determinant;
    n.b[i] -= (fa * g - ga * f) / determinant;
  }
}

/// Light of the lamp at `lamp` (local frame) on the surface, seen from the batch's origin. Inverse square law and
/// cosine; the mirror slope is that of a bump whose normal halves the angle between lamp and camera.
HEARTSERVO_SIMD
void light_batch(const Batch& n, const double* lamp, double reference2, const float* vignette, float* shade,
                 float* slope_a, float* slope_b) {
  const double ox = n.origin[0], oy = n.origin[1], oz = n.origin[2], lx = lamp[0], ly = lamp[1], lz = lamp[2];
  for (int i = 0; i < n.count; ++i) {
    double nx = n.zb[i] * n.ya[i] - n.za[i] * n.yb[i], ny = n.xb[i] * n.za[i] - n.xa[i] * n.zb[i];
    double nz = n.yb[i] * n.xa[i] - n.ya[i] * n.xb[i];
    const double norm = -1 / std::sqrt(nx * nx + ny * ny + nz * nz);  // the normal looks at the camera
    nx *= norm, ny *= norm, nz *= norm;
    double ux = lx - n.x[i], uy = ly - n.y[i], uz = lz - n.z[i];
    const double distance2 = ux * ux + uy * uy + uz * uz, u = 1 / std::sqrt(distance2);
    ux *= u, uy *= u, uz *= u;
    const double wx = ox - n.x[i], wy = oy - n.y[i], wz = oz - n.z[i], w = 1 / std::sqrt(wx * wx + wy * wy + wz * wz);
    const double hx = ux + wx * w, hy = uy + wy * w, hz = uz + wz * w;
    const double cosine = ux * nx + uy * ny + uz * nz, hn = -1 / (hx * nx + hy * ny + hz * nz);
    shade[i] = static_cast<float>(reference2 / distance2 * (cosine > 0 ? cosine : 0)) * vignette[i];
    slope_a[i] = static_cast<float>((hx * n.xa[i] + hy * n.ya[i] + hz * n.za[i]) * hn);
    slope_b[i] = static_cast<float>((hx * n.xb[i] + hy * n.yb[i] + hz * n.zb[i]) * hn);
  }
}

}  // namespace

SurfaceNodes::SurfaceNodes(const tracking::Camera& camera, const PictureOptions& options, double texels_per_m)
    : grid_(camera.width, camera.height),
      rays_(node_rays(camera, grid_)),
      vignette_(static_cast<std::size_t>(grid_.size())),
      planes_(static_cast<std::size_t>(kChannels) * grid_.size()),
      light_m_(options.light_position_m),
      light_distance2_(options.light_distance_m * options.light_distance_m),
      texels_per_m_(texels_per_m),
      flat_(options.light == "flat") {
  const double corner2 = 0.25 * (camera.width * camera.width + camera.height * camera.height);
  for (int k = 0; k < grid_.size(); ++k) {
    const double du = grid_.u_px(k % grid_.columns()) - (camera.width - 1) / 2.0;
    const double dv = grid_.v_px(k / grid_.columns()) - (camera.height - 1) / 2.0;
    const double r2 = (du * du + dv * dv) / corner2;
    vignette_[k] = static_cast<float>(options.exposure * (1 - options.vignetting * r2 * r2));
  }
}

void SurfaceNodes::solve(const SurfaceState& state, int first, int last) {
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> R = state.R_camera_local;
  const Eigen::Vector3d origin = -(R.transpose() * state.t_camera_local);
  const Eigen::Vector3d lamp = R.transpose() * light_m_ + origin;
  const int size = grid_.size();
  Batch batch;
  for (int k = 0; k < 3; ++k) batch.origin[k] = origin(k);
  for (int begin = first; begin < last; begin += kBatch) {
    batch.count = std::min(kBatch, last - begin);
    enter_rays(rays_.data() + begin, rays_.data() + size + begin, R.data(), batch);
    for (int step = 0; step < kNewtonSteps; ++step) {
      evaluate_tissue(state.tissue, batch);
      for (const Plate& plate : state.plates) evaluate_plate(plate, batch);
      newton_step(batch);
    }
    float* out = planes_.data() + begin;
    for (int i = 0; i < batch.count; ++i) {
      out[kTexelX * size + i] = static_cast<float>(batch.a[i] * texels_per_m_);
      out[kTexelY * size + i] = static_cast<float>(batch.b[i] * texels_per_m_);
    }
    if (flat_) {
      std::fill_n(out + kShade * size, batch.count, 1.f);
      std::fill_n(out + kMirrorSlopeA * size, batch.count, 0.f);
      std::fill_n(out + kMirrorSlopeB * size, batch.count, 0.f);
    } else {
      light_batch(batch, lamp.data(), light_distance2_, vignette_.data() + begin, out + kShade * size,
                  out + kMirrorSlopeA * size, out + kMirrorSlopeB * size);
    }
  }
}

}  // namespace heartservo::sim
