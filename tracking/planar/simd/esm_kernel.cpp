#include "tracking/planar/simd/esm_kernel.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>

#include "tracking/planar/simd/select.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tracking/planar/simd/esm_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef HEARTSERVO_ESM_KERNEL_ONCE
#define HEARTSERVO_ESM_KERNEL_ONCE
namespace heartservo::tracking::simd {

inline constexpr float kUnusable = 1e6F;  // grey of the template: its residual has no weight
inline constexpr int kRowsAtOnce = 32;    // whose values stay in the first-level cache between the loops
inline constexpr int kPerPoint = 6;       // values kept for the second and third loop

// Sums over a strip of products with powers of y; lane by lane. Names: a = gx gx, b = gx gy, c = gy gy, x = gx, y = gy,
// g = grey, r = residual, 1; then the power of y. All weighted.
enum Sum {
  XR0, XR1, YR0, YR1, YR2, GR, R, W, POINTS, kLightSums,
  A0 = kLightSums, A1, A2, B0, B1, B2, B3, C0, C1, C2, C3, C4,
  XG0, XG1, X0, X1, YG0, YG1, YG2, Y0, Y1, Y2, GG, G, kSums
};

struct Sampled {
  std::size_t n = 0, count = 0;  // values written, points that they are of
};

inline constexpr int kPowers = 5;
// m[k]: sum over everything of s x^k.
struct Moments {
  double m[kPowers];
};

// What the strips' sums are worth in the normal equations. Each parameter p has J_p = gx * P(x, y) + gy * Q(x, y) with
// at most one term in each; a product's moment is the one of the summed powers.
struct Term {
  double sign;
  int x, y;  // powers
};
inline constexpr Term kNone{0, 0, 0};
inline constexpr Term kOfX[8] = {{1, 0, 0}, kNone, {1, 0, 1}, kNone, {1, 1, 0}, {1, 1, 0}, {-1, 2, 0}, {-1, 1, 1}};
inline constexpr Term kOfY[8] = {kNone, {1, 0, 0}, kNone, {1, 1, 0}, {-1, 0, 1}, {1, 0, 1}, {-1, 1, 1}, {-1, 0, 2}};

inline double product(const Term& p, const Term& q, int first, const Moments* m) {
  return p.sign == 0 || q.sign == 0 ? 0 : p.sign * q.sign * m[first + p.y + q.y].m[p.x + q.x];
}
inline double single(const Term& p, int first, const Moments* m) {
  return p.sign == 0 ? 0 : p.sign * m[first + p.y].m[p.x];
}

inline void add_light(const Moments* m, EsmSums& sums) {
  for (int p = 0; p < 8; ++p) sums.Jtr[p] += single(kOfX[p], XR0, m) + single(kOfY[p], YR0, m);
  sums.Jtr[8] += m[GR].m[0];
  sums.Jtr[9] += m[R].m[0];
  sums.weight += m[W].m[0];
  sums.points += m[POINTS].m[0];
}

inline void add_full(const Moments* m, EsmMatrix& JtJ) {
  for (int p = 0; p < 8; ++p) {
    for (int q = 0; q <= p; ++q)
      JtJ(p, q) += product(kOfX[p], kOfX[q], A0, m) + product(kOfX[p], kOfY[q], B0, m) +
                   product(kOfY[p], kOfX[q], B0, m) + product(kOfY[p], kOfY[q], C0, m);
    JtJ(8, p) += single(kOfX[p], XG0, m) + single(kOfY[p], YG0, m);
    JtJ(9, p) += single(kOfX[p], X0, m) + single(kOfY[p], Y0, m);
  }
  JtJ(8, 8) += m[GG].m[0];
  JtJ(9, 8) += m[G].m[0];
  JtJ(9, 9) += m[W].m[0];
}

}  // namespace heartservo::tracking::simd
#endif

HWY_BEFORE_NAMESPACE();
namespace heartservo::tracking::simd {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::ScalableTag<float>;
using V = hn::Vec<Floats>;

int lanes_of() { return static_cast<int>(hn::Lanes(Floats())); }

// Residual of a vector of points, and 1 where it counts: usable, it and its neighbours in the picture and no glare.
struct Seen {
  V grey, residual, right, left, down, up;
  hn::Mask<Floats> clear;
};

HWY_INLINE Seen see(const EsmJob& job, std::ptrdiff_t stride, std::ptrdiff_t at, const float* reference) {
  const Floats d;
  const float* g = job.grey + at;
  Seen s;
  s.grey = hn::LoadU(d, g);
  s.left = hn::LoadU(d, g - 1), s.right = hn::LoadU(d, g + 1);
  s.up = hn::LoadU(d, g - stride), s.down = hn::LoadU(d, g + stride);
  V gain = hn::Set(d, job.gain);
  if (job.gain_offset) gain = hn::Add(gain, hn::LoadU(d, job.gain_offset + at));
  const V expected = hn::Load(d, reference);
  s.residual = hn::Sub(hn::MulAdd(gain, s.grey, hn::Set(d, job.bias)), expected);
  const V brightest = hn::Max(s.grey, hn::Max(hn::Max(s.left, s.right), hn::Max(s.up, s.down)));
  s.clear = hn::And(hn::Lt(brightest, hn::Set(d, job.saturated)), hn::Lt(expected, hn::Set(d, 0.5F * kUnusable)));
  return s;
}

// Writes |residual| of some of the points; infinite where a point says nothing.
Sampled sample_residuals(const EsmTemplate& t, const EsmJob& job, float* scratch) {
  const Floats d;
  const int lanes = lanes_of(), rows = t.height - 2;
  const std::size_t vectors = static_cast<std::size_t>(t.strips) * static_cast<std::size_t>(rows);
  const std::size_t most = kMedianPoints / static_cast<std::size_t>(lanes);
  const std::size_t every = std::max<std::size_t>(1, (vectors + most - 1) / most);
  const V none = hn::Set(d, std::numeric_limits<float>::infinity());
  Sampled sampled;
  for (std::size_t i = every / 2; i < vectors; i += every) {
    const auto strip = static_cast<int>(i / static_cast<std::size_t>(rows)), row = static_cast<int>(i) - strip * rows;
    const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(row + 1) * t.width + 1 + strip * lanes;
    const Seen s = see(job, t.width, at, t.values.data() + i * 3 * static_cast<std::size_t>(lanes));
    hn::Store(hn::IfThenElse(s.clear, hn::Abs(s.residual), none), d, scratch + sampled.n);
    sampled.n += static_cast<std::size_t>(lanes);
    sampled.count += hn::CountTrue(d, s.clear);
  }
  return sampled;
}

// Adds a strip's sums, times the powers of x, to those of the strips before; all lane by lane.
HWY_INLINE void add_moments(V x, const V* acc, int n, V (*m)[kPowers]) {
  const V xx = hn::Mul(x, x);
  for (int k = 0; k < n; ++k) {
    const V v = hn::Mul(acc[k], xx);
    m[k][0] = hn::Add(m[k][0], acc[k]);
    m[k][1] = hn::MulAdd(acc[k], x, m[k][1]);
    m[k][2] = hn::Add(m[k][2], v);
    if (k >= A0 && k <= B3) {
      m[k][3] = hn::MulAdd(v, x, m[k][3]);
      m[k][4] = hn::MulAdd(v, xx, m[k][4]);
    }
  }
}

// The second and third loop over rows whose values are in `kept`.
HWY_INLINE void add_products(const EsmTemplate& t, const float* kept, int first_row, int rows, V* acc) {
  const Floats d;
  const int lanes = lanes_of();
  const auto y_of = [&](int row) { return t.first_y + static_cast<float>(first_row + row) * t.step; };
  V a0 = acc[A0], a1 = acc[A1], a2 = acc[A2], b0 = acc[B0], b1 = acc[B1], b2 = acc[B2], b3 = acc[B3];
  V c0 = acc[C0], c1 = acc[C1], c2 = acc[C2], c3 = acc[C3], c4 = acc[C4];
  for (int row = 0; row < rows; ++row) {
    const float* k = kept + row * kPerPoint * lanes;
    const V gx = hn::Load(d, k), gy = hn::Load(d, k + lanes), wx = hn::Load(d, k + 2 * lanes),
            wy = hn::Load(d, k + 3 * lanes), y = hn::Set(d, y_of(row)), yy = hn::Mul(y, y);
    V p = hn::Mul(wx, gx);
    a0 = hn::Add(a0, p), a1 = hn::MulAdd(p, y, a1), a2 = hn::MulAdd(p, yy, a2);
    p = hn::Mul(wx, gy);
    b0 = hn::Add(b0, p), b1 = hn::MulAdd(p, y, b1), b2 = hn::MulAdd(p, yy, b2);
    b3 = hn::MulAdd(hn::Mul(p, yy), y, b3);
    p = hn::Mul(wy, gy);
    c0 = hn::Add(c0, p), c1 = hn::MulAdd(p, y, c1), c2 = hn::MulAdd(p, yy, c2);
    p = hn::Mul(p, yy);
    c3 = hn::MulAdd(p, y, c3), c4 = hn::MulAdd(p, yy, c4);
  }
  acc[A0] = a0, acc[A1] = a1, acc[A2] = a2, acc[B0] = b0, acc[B1] = b1, acc[B2] = b2, acc[B3] = b3;
  acc[C0] = c0, acc[C1] = c1, acc[C2] = c2, acc[C3] = c3, acc[C4] = c4;
  V xg0 = acc[XG0], xg1 = acc[XG1], x0 = acc[X0], x1 = acc[X1], gg = acc[GG], gs = acc[G];
  V yg0 = acc[YG0], yg1 = acc[YG1], yg2 = acc[YG2], y0 = acc[Y0], y1 = acc[Y1], y2 = acc[Y2];
  for (int row = 0; row < rows; ++row) {
    const float* k = kept + row * kPerPoint * lanes;
    const V wx = hn::Load(d, k + 2 * lanes), wy = hn::Load(d, k + 3 * lanes), g = hn::Load(d, k + 4 * lanes),
            w = hn::Load(d, k + 5 * lanes), y = hn::Set(d, y_of(row));
    const V wxy = hn::Mul(wx, y), wyy = hn::Mul(wy, y), wyyy = hn::Mul(wyy, y), wg = hn::Mul(w, g);
    xg0 = hn::MulAdd(wx, g, xg0), xg1 = hn::MulAdd(wxy, g, xg1);
    x0 = hn::Add(x0, wx), x1 = hn::Add(x1, wxy);
    yg0 = hn::MulAdd(wy, g, yg0), yg1 = hn::MulAdd(wyy, g, yg1), yg2 = hn::MulAdd(wyyy, g, yg2);
    y0 = hn::Add(y0, wy), y1 = hn::Add(y1, wyy), y2 = hn::Add(y2, wyyy);
    gg = hn::MulAdd(wg, g, gg), gs = hn::Add(gs, wg);
  }
  acc[XG0] = xg0, acc[XG1] = xg1, acc[X0] = x0, acc[X1] = x1, acc[GG] = gg, acc[G] = gs;
  acc[YG0] = yg0, acc[YG1] = yg1, acc[YG2] = yg2, acc[Y0] = y0, acc[Y1] = y1, acc[Y2] = y2;
}

HWY_INLINE V robust_weight(const Seen& s, V inverse_scale) {
  const Floats d;
  const V e = hn::Mul(s.residual, inverse_scale), bell = hn::Max(hn::Zero(d), hn::NegMulAdd(e, e, hn::Set(d, 1)));
  return hn::IfThenElseZero(s.clear, hn::Mul(bell, bell));
}

template <bool kFull>
HWY_INLINE void sweep_rows(const EsmTemplate& t, const EsmJob& job, const float* values, std::ptrdiff_t at,
                           int first_row, int rows, float* HWY_RESTRICT kept, V* acc) {
  const Floats d;
  const int lanes = lanes_of();
  const V one = hn::Set(d, 1), inverse_scale = hn::Set(d, job.inverse_scale);
  const V half_gain = hn::Set(d, t.picture_share * 0.5F * job.gain / t.step);
  V xr0 = acc[XR0], xr1 = acc[XR1], yr0 = acc[YR0], yr1 = acc[YR1], yr2 = acc[YR2];
  V gr = acc[GR], rs = acc[R], ws = acc[W], points = acc[POINTS];
  for (int row = 0; row < rows; ++row, at += t.width, values += 3 * lanes) {
    const Seen s = see(job, t.width, at, values);
    const V w = robust_weight(s, inverse_scale);
    const V gx = hn::MulAdd(half_gain, hn::Sub(s.right, s.left), hn::Load(d, values + lanes));
    const V gy = hn::MulAdd(half_gain, hn::Sub(s.down, s.up), hn::Load(d, values + 2 * lanes));
    const V y = hn::Set(d, t.first_y + static_cast<float>(first_row + row) * t.step);
    const V wr = hn::Mul(w, s.residual), u = hn::Mul(gx, wr), v = hn::Mul(gy, wr), vy = hn::Mul(v, y);
    xr0 = hn::Add(xr0, u), xr1 = hn::MulAdd(u, y, xr1);
    yr0 = hn::Add(yr0, v), yr1 = hn::Add(yr1, vy), yr2 = hn::MulAdd(vy, y, yr2);
    gr = hn::MulAdd(wr, s.grey, gr), rs = hn::Add(rs, wr), ws = hn::Add(ws, w);
    points = hn::Add(points, hn::IfThenElseZero(s.clear, one));
    if constexpr (kFull) {
      float* k = kept + row * kPerPoint * lanes;
      hn::Store(gx, d, k), hn::Store(gy, d, k + lanes);
      hn::Store(hn::Mul(w, gx), d, k + 2 * lanes), hn::Store(hn::Mul(w, gy), d, k + 3 * lanes);
      hn::Store(s.grey, d, k + 4 * lanes), hn::Store(w, d, k + 5 * lanes);
    }
  }
  acc[XR0] = xr0, acc[XR1] = xr1, acc[YR0] = yr0, acc[YR1] = yr1, acc[YR2] = yr2;
  acc[GR] = gr, acc[R] = rs, acc[W] = ws, acc[POINTS] = points;
}

void sweep(const EsmTemplate& t, const EsmJob& job, EsmSums& sums, EsmMatrix* JtJ, float* kept) {
  const Floats d;
  const int lanes = lanes_of(), rows = t.height - 2, n = JtJ ? kSums : kLightSums;
  V m[kSums][kPowers];
  for (int k = 0; k < n; ++k)
    for (V& v : m[k]) v = hn::Zero(d);
  for (int strip = 0; strip < t.strips; ++strip) {
    V acc[kSums];
    for (int k = 0; k < n; ++k) acc[k] = hn::Zero(d);
    const float* values = t.values.data() + static_cast<std::ptrdiff_t>(strip) * rows * 3 * lanes;
    for (int row = 0; row < rows; row += kRowsAtOnce) {
      const int count = std::min(kRowsAtOnce, rows - row);
      const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(row + 1) * t.width + 1 + strip * lanes;
      const float* from = values + static_cast<std::ptrdiff_t>(row) * 3 * lanes;
      if (JtJ) {
        sweep_rows<true>(t, job, from, at, row, count, kept, acc);
        add_products(t, kept, row, count, acc);
      } else {
        sweep_rows<false>(t, job, from, at, row, count, kept, acc);
      }
    }
    const V x = hn::MulAdd(hn::Iota(d, static_cast<float>(strip * lanes)), hn::Set(d, t.step), hn::Set(d, t.first_x));
    add_moments(x, acc, n, m);
  }
  Moments moments[kSums];
  for (int k = 0; k < n; ++k)
    for (int p = 0; p < kPowers; ++p)
      moments[k].m[p] = static_cast<double>(hn::GetLane(hn::SumOfLanes(d, m[k][p])));
  add_light(moments, sums);
  if (JtJ) add_full(moments, *JtJ);
}

// Calls `use` for every vector of points.
template <class Use>
HWY_INLINE void for_all(const EsmTemplate& t, const EsmJob& job, const Use& use) {
  const int lanes = lanes_of(), rows = t.height - 2;
  const float* values = t.values.data();
  for (int strip = 0; strip < t.strips; ++strip)
    for (int row = 0; row < rows; ++row, values += 3 * lanes) {
      const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(row + 1) * t.width + 1 + strip * lanes;
      use(see(job, t.width, at, values), values, at, strip);
    }
}

struct Pairs {
  V n, a, c, aa, cc, ac;
  Pairs() { n = a = c = aa = cc = ac = hn::Zero(Floats()); }
  HWY_INLINE void add(V w, V x, V y) {
    const V wx = hn::Mul(w, x), wy = hn::Mul(w, y);
    n = hn::Add(n, w), a = hn::Add(a, wx), c = hn::Add(c, wy);
    aa = hn::MulAdd(wx, x, aa), cc = hn::MulAdd(wy, y, cc), ac = hn::MulAdd(wx, y, ac);
  }
  PairSums sums() const {
    const auto sum = [](V v) HWY_ATTR { return static_cast<double>(hn::GetLane(hn::SumOfLanes(Floats(), v))); };
    return {sum(n), sum(a), sum(c), sum(aa), sum(cc), sum(ac)};
  }
};

void add_pairs(const EsmTemplate& t, const EsmJob& job, PairSums& believed, PairSums& all) {
  const Floats d;
  const V one = hn::Set(d, 1), inverse_scale = hn::Set(d, job.inverse_scale), middle = hn::Set(d, kPairOrigin);
  Pairs some, every;
  for_all(t, job, [&](const Seen& s, const float* values, std::ptrdiff_t, int) HWY_ATTR {
    const V expected = hn::Load(d, values);
    // gain * grey = residual + template - bias
    const V x = hn::Add(s.residual, hn::Sub(expected, hn::Set(d, job.bias + kPairOrigin))), y = hn::Sub(expected, middle);
    const auto there = hn::And(hn::Lt(s.grey, hn::Set(d, job.saturated)), hn::Lt(expected, hn::Set(d, 0.5F * kUnusable)));
    const V zero = hn::Zero(d);
    every.add(hn::IfThenElseZero(there, one), hn::IfThenElse(there, x, zero), hn::IfThenElse(there, y, zero));
    some.add(robust_weight(s, inverse_scale), hn::IfThenElse(there, x, zero), hn::IfThenElse(there, y, zero));
  });
  believed = some.sums();
  all = every.sums();
}

void write_weights(const EsmTemplate& t, const EsmJob& job, EsmSums& sums, float* residual, float* weight) {
  const Floats d;
  const int lanes = lanes_of();
  const V one = hn::Set(d, 1), inverse_scale = hn::Set(d, job.inverse_scale);
  V ws = hn::Zero(d), points = hn::Zero(d);
  const auto tail = hn::FirstN(d, static_cast<std::size_t>(t.width - 2 - (t.strips - 1) * lanes));
  for_all(t, job, [&](const Seen& s, const float*, std::ptrdiff_t at, int strip) HWY_ATTR {
    const V w = robust_weight(s, inverse_scale);
    ws = hn::Add(ws, w);
    points = hn::Add(points, hn::IfThenElseZero(s.clear, one));
    if (strip + 1 < t.strips) {
      hn::StoreU(w, d, weight + at), hn::StoreU(s.residual, d, residual + at);
    } else {
      hn::BlendedStore(w, tail, d, weight + at), hn::BlendedStore(s.residual, tail, d, residual + at);
    }
  });
  sums.weight = static_cast<double>(hn::GetLane(hn::SumOfLanes(d, ws)));
  sums.points = static_cast<double>(hn::GetLane(hn::SumOfLanes(d, points)));
}

}  // namespace HWY_NAMESPACE
}  // namespace heartservo::tracking::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace heartservo::tracking::simd {

HWY_EXPORT(lanes_of);
HWY_EXPORT(sample_residuals);
HWY_EXPORT(sweep);
HWY_EXPORT(add_pairs);
HWY_EXPORT(write_weights);

float median_residual(const EsmTemplate& t, const EsmJob& job, AlignedFloats& scratch) {
  float* values = at_least(scratch, kMedianPoints + 16);
  const Sampled sampled = HWY_DYNAMIC_DISPATCH(sample_residuals)(t, job, values);
  std::fill_n(values + sampled.n, 16, std::numeric_limits<float>::infinity());
  return sampled.count > 0 ? select(values, sampled.n, sampled.count / 2) : 0;
}

void esm_sweep(const EsmTemplate& t, const EsmJob& job, EsmSums& sums, EsmMatrix* JtJ, AlignedFloats& scratch) {
  sums.points = sums.weight = 0;
  sums.Jtr.setZero();
  if (JtJ) JtJ->setZero();
  const auto n = static_cast<std::size_t>(kRowsAtOnce * kPerPoint * t.lanes);
  HWY_DYNAMIC_DISPATCH(sweep)(t, job, sums, JtJ, at_least(scratch, n));
  if (JtJ) JtJ->triangularView<Eigen::StrictlyUpper>() = JtJ->transpose();
}

void pair_sums(const EsmTemplate& t, const EsmJob& job, PairSums& believed, PairSums& all) {
  HWY_DYNAMIC_DISPATCH(add_pairs)(t, job, believed, all);
}

void weigh(const EsmTemplate& t, const EsmJob& job, EsmSums& sums, float* residual, float* weight) {
  HWY_DYNAMIC_DISPATCH(write_weights)(t, job, sums, residual, weight);
}

EsmTemplate::EsmTemplate(const Patch& patch)
    : width(patch.width), height(patch.height), lanes(HWY_DYNAMIC_DISPATCH(lanes_of)()), first_x(patch.x_of(1)),
      first_y(patch.y_of(1)), step(patch.step), picture_share(1 - patch.template_share) {
  strips = std::max(0, (width - 2 + lanes - 1) / lanes);
  for (int strip = 0; strip < strips; ++strip)
    for (int row = 1; row + 1 < height; ++row) {
      const auto at = [&](int i) { return static_cast<std::size_t>(row * width + 1 + strip * lanes + i); };
      const auto usable_at = [&](int i) { return 1 + strip * lanes + i < width - 1 && patch.usable[at(i)] > 0; };
      for (int i = 0; i < lanes; ++i) {
        values.push_back(usable_at(i) ? patch.grey[at(i)] : kUnusable);
        usable += usable_at(i);
      }
      for (int i = 0; i < lanes; ++i) values.push_back(usable_at(i) ? patch.template_share * patch.gradient_x[at(i)] : 0);
      for (int i = 0; i < lanes; ++i) values.push_back(usable_at(i) ? patch.template_share * patch.gradient_y[at(i)] : 0);
    }
}

}  // namespace heartservo::tracking::simd
#endif
