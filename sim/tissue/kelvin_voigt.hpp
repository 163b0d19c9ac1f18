#pragma once
// Soft tissue under the tip: a spring and a damper side by side (Kelvin and Voigt), which push but never pull,
//
//   f = max(0, k d + c d'),   d > 0 the depth of the tip below the undeformed surface, along its normal.
//
// The heart is taken as far heavier than what it yields to: contact deforms the tissue and leaves its motion alone.
#include <string>
#include <vector>

#include "tracking/settings/fields.hpp"

namespace heartservo::sim {

struct TissueOptions {
  double stiffness_n_m = 300;
  double damping_ns_m = 2;
  double force_noise_n = 0.01;

  void fields(FieldVisitor& v) {
    v.field({"stiffness_n_m", "N/m", "of the tissue under the tip", 1, 1e5}, stiffness_n_m);
    v.field({"damping_ns_m", "N s/m", "of the tissue under the tip", 0, 1e3}, damping_ns_m);
    v.field({"force_noise_n", "N", "standard deviation of the force sensor", 0, 10}, force_noise_n);
  }
};

/// N; depth in m, its rate in m/s.
inline double contact_force(const TissueOptions& tissue, double depth, double rate) {
  if (depth <= 0) return 0;
  const double force = tissue.stiffness_n_m * depth + tissue.damping_ns_m * rate;
  return force > 0 ? force : 0;
}

}  // namespace heartservo::sim
