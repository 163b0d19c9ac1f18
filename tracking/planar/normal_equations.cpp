#include "tracking/planar/normal_equations.hpp"

#include <algorithm>
#include <cmath>

namespace heartservo::tracking {

namespace {

simd::EsmJob job_of(const Light& light, const AlignmentBuffers& b, double inverse_scale) {
  return {b.grey.data(),
          light.gain_offset,
          static_cast<float>(light.gain),
          static_cast<float>(light.bias),
          kSaturatedGrey,
          static_cast<float>(inverse_scale)};
}

// Sets the scale of the weights.
simd::EsmJob weighed_job(const simd::EsmTemplate& reference, const Light& light, AlignmentBuffers& b, double bound,
                         AlignmentPass& pass) {
  simd::EsmJob job = job_of(light, b, 0);
  pass.noise_grey = 1.4826 * static_cast<double>(simd::median_residual(reference, job, b.scratch));
  pass.inverse_scale = 1 / (bound * std::max(pass.noise_grey, kSmallestNoise));
  job.inverse_scale = static_cast<float>(pass.inverse_scale);
  return job;
}

double correlation_of(const simd::PairSums& s) {
  if (s.n <= 0) return 0;
  const double va = s.aa - s.a * s.a / s.n, vc = s.cc - s.c * s.c / s.n;
  return va > 0 && vc > 0 ? (s.ac - s.a * s.c / s.n) / std::sqrt(va * vc) : 0;
}

}  // namespace

void AlignmentBuffers::resize(std::size_t n) {
  for (auto* v : {&grey, &residual, &weight}) v->resize(std::max(v->size(), n + simd::kEsmPad));
}

void esm_pass(const simd::EsmTemplate& reference, const Light& light, AlignmentBuffers& b, AlignmentPass& pass,
              bool with_JtJ, double bound) {
  const simd::EsmJob job = weighed_job(reference, light, b, bound, pass);
  simd::EsmSums sums;
  simd::esm_sweep(reference, job, sums, with_JtJ ? &pass.JtJ : nullptr, b.scratch);
  pass.Jtr = sums.Jtr;
  pass.points = sums.points;
  pass.weight = sums.weight;
}

void weigh_points(const simd::EsmTemplate& reference, const Light& light, AlignmentBuffers& b, AlignmentPass& pass,
                  double bound) {
  const simd::EsmJob job = weighed_job(reference, light, b, bound, pass);
  simd::EsmSums sums;
  simd::weigh(reference, job, sums, b.residual.data(), b.weight.data());
  pass.points = sums.points;
  pass.weight = sums.weight;
}

Correlation correlation(const simd::EsmTemplate& reference, const Light& light, const AlignmentBuffers& b,
                        const AlignmentPass& pass) {
  simd::PairSums believed, all;
  simd::pair_sums(reference, job_of(light, b, pass.inverse_scale), believed, all);
  return {correlation_of(believed), correlation_of(all)};
}

bool fit_light(const simd::EsmTemplate& reference, const AlignmentBuffers& b, const AlignmentPass* pass, Light& light) {
  simd::PairSums believed, all;
  simd::pair_sums(reference, job_of(light, b, pass ? pass->inverse_scale : 0), believed, all);
  const simd::PairSums& s = pass ? believed : all;
  const double n = s.n, variance = s.aa - s.a * s.a / n;
  if (!(n > 0) || !(variance > 1e-3 * n * light.gain * light.gain)) return false;
  const double more = (s.ac - s.a * s.c / n) / variance;
  const double gain = more * light.gain, bias = simd::kPairOrigin + (s.c - more * s.a) / n - more * simd::kPairOrigin;
  if (!std::isfinite(gain) || !std::isfinite(bias)) return false;
  light.gain = gain, light.bias = bias;
  return true;
}

}  // namespace heartservo::tracking
