#pragma once
// The heart's surface at one instant, as plain numbers and straight-line functions of them: the same code serves the
// ground truth (one point) and the renderer (rows of points, vectorised by the compiler).
//
// Local frame: origin at the anchor, axes parallel to the camera's at rest (x right, y down, z away from the camera).
// Material coordinates (a, b), m, name a piece of tissue: at rest, without landmarks, it lies at local (a, b, sag(a,
// b)).
#include <Eigen/Core>
#include <vector>

namespace heartservo::sim {

/// A point of the surface with its derivatives by a and b; local frame, m.
struct SurfacePoint {
  double x, y, z;
  double xa, ya, za;
  double xb, yb, zb;
};

/// A stiff plate: exactly c + p e1 + q e2 inside, blended into the tissue around it.
struct Plate {
  double a, b;                ///< centre, material coordinates
  double cosine, sine;        ///< of the angle in its plane
  double inner;               ///< m; the weight is 0 where the 8-norm of (p, q) is below, which includes the square
  double blend;               ///< m; the weight reaches 1 this much further out
  double c[3], e1[3], e2[3];  ///< local frame; e1, e2 orthonormal
};

/// One smooth wave of deformation, d sin(ka a + kb b + phase).
struct DeformationMode {
  double ka, kb, phase;
  double d[3];  ///< m; present amplitude
};

inline constexpr int kDeformationModes = 5;

struct Tissue {
  double sag_scale;    ///< m; R slope^2
  double inverse_rs2;  ///< 1 / (R slope)^2
  DeformationMode modes[kDeformationModes];
};

struct SurfaceState {
  Tissue tissue;
  std::vector<Plate> plates;
  Eigen::Matrix3d R_camera_local;
  Eigen::Vector3d t_camera_local;

  /// Camera frame, m.
  Eigen::Vector3d point(double a, double b) const;
};

#define HEARTSERVO_INLINE inline __attribute__((always_inline))

/// sin and cos to 1e-10 for |x| < 1e5, without branches or calls, so that loops over it vectorise.
HEARTSERVO_INLINE void sine_cosine(double x, double& sine, double& cosine) {
  constexpr double kRound = 6755399441055744.0;  // 1.5 2^52: adding and subtracting it rounds to the nearest integer
  const double turns = (x * 0.31830988618379067 + kRound) - kRound;
  const double r = (x - turns * 3.141592653589793) - turns * 1.2246467991473532e-16;
  const double half = 0.5 * turns;
  const double odd = half - ((half + kRound) - kRound);  // 0 or +-0.5
  const double sign = 1 - 8 * odd * odd;
  const double q = r * r;
  sine = sign * r *
         (1 + q * (-1 / 6. +
                   q * (1 / 120. +
                        q * (-1 / 5040. +
                             q * (1 / 362880. + q * (-1 / 39916800. + q * (1 / 6227020800. - q / 1307674368000.)))))));
  cosine =
      sign *
      (1 +
       q * (-0.5 + q * (1 / 24. + q * (-1 / 720. + q * (1 / 40320. + q * (-1 / 3628800. +
                                                                          q * (1 / 479001600. - q / 87178291200.)))))));
}

/// The deforming tissue, without plates.
HEARTSERVO_INLINE SurfacePoint tissue_point(const Tissue& s, double a, double b) {
  // A hyperboloid: curvature 1 / R at the anchor, slope limited far from it. Unlike a sphere it has no rim.
  const double root = __builtin_sqrt(1 + (a * a + b * b) * s.inverse_rs2);
  const double slope = s.sag_scale * s.inverse_rs2 / root;
  SurfacePoint p{a, b, s.sag_scale * (root - 1), 1, 0, slope * a, 0, 1, slope * b};
  for (int i = 0; i < kDeformationModes; ++i) {
    const DeformationMode& m = s.modes[i];
    double sine, cosine;
    sine_cosine(m.ka * a + m.kb * b + m.phase, sine, cosine);
    const double ca = m.ka * cosine, cb = m.kb * cosine;
    p.x += m.d[0] * sine, p.xa += m.d[0] * ca, p.xb += m.d[0] * cb;
    p.y += m.d[1] * sine, p.ya += m.d[1] * ca, p.yb += m.d[1] * cb;
    p.z += m.d[2] * sine, p.za += m.d[2] * ca, p.zb += m.d[2] * cb;
  }
  return p;
}

/// v = plate + w (v - plate) and its derivatives, for one component.
HEARTSERVO_INLINE void mix(double plate, double plate_a, double plate_b, double w, double wa, double wb, double& v,
                           double& va, double& vb) {
  const double d = v - plate;
  va = plate_a + w * (va - plate_a) + wa * d;
  vb = plate_b + w * (vb - plate_b) + wb * d;
  v = plate + w * d;
}

/// Lays a plate over the point (a, b) of the surface.
HEARTSERVO_INLINE void lay_plate(const Plate& plate, double a, double b, SurfacePoint& s) {
  const double p = plate.cosine * (a - plate.a) + plate.sine * (b - plate.b);
  const double q = plate.cosine * (b - plate.b) - plate.sine * (a - plate.a);
  // The 8-norm of (p, q) is a smooth stand-in for the distance from a square.
  const double P = p / plate.inner, Q = q / plate.inner;
  const double P2 = P * P, Q2 = Q * Q, P6 = P2 * P2 * P2, Q6 = Q2 * Q2 * Q2;
  const double n8 = P6 * P2 + Q6 * Q2 + 1e-12;
  const double n = __builtin_sqrt(__builtin_sqrt(__builtin_sqrt(n8)));
  const double ratio = plate.inner / plate.blend;
  double u = (n - 1) * ratio;
  u = u > 0 ? u : 0;
  u = u < 1 ? u : 1;
  const double w = u * u * u * u * (35 + u * (-84 + u * (70 - 20 * u)));  // three derivatives vanish at 0 and 1
  const double du = 140 * u * u * u * (1 - u) * (1 - u) * (1 - u) * n / (n8 * plate.blend);
  const double wp = du * P6 * P, wq = du * Q6 * Q;
  const double wa = plate.cosine * wp - plate.sine * wq, wb = plate.sine * wp + plate.cosine * wq;
  const double* c = plate.c;
  const double* e = plate.e1;
  const double* f = plate.e2;
  const double cs = plate.cosine, sn = plate.sine;
  mix(c[0] + p * e[0] + q * f[0], cs * e[0] - sn * f[0], sn * e[0] + cs * f[0], w, wa, wb, s.x, s.xa, s.xb);
  mix(c[1] + p * e[1] + q * f[1], cs * e[1] - sn * f[1], sn * e[1] + cs * f[1], w, wa, wb, s.y, s.ya, s.yb);
  mix(c[2] + p * e[2] + q * f[2], cs * e[2] - sn * f[2], sn * e[2] + cs * f[2], w, wa, wb, s.z, s.za, s.zb);
}

/// The surface at one point, plates included.
inline SurfacePoint surface_point(const SurfaceState& state, double a, double b) {
  SurfacePoint p = tissue_point(state.tissue, a, b);
  for (const Plate& plate : state.plates) lay_plate(plate, a, b, p);
  return p;
}

inline Eigen::Vector3d SurfaceState::point(double a, double b) const {
  const SurfacePoint p = surface_point(*this, a, b);
  return t_camera_local + R_camera_local * Eigen::Vector3d(p.x, p.y, p.z);
}

}  // namespace heartservo::sim
