#include "tracking/planar/simd/warp_kernel.hpp"

#include <algorithm>
#include <cstdint>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tracking/planar/simd/warp_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "tracking/planar/simd/fetch-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace heartservo::tracking::simd {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::ScalableTag<float>;
using Ints = hn::RebindToSigned<Floats>;
using V = hn::Vec<Floats>;
using VI = hn::Vec<Ints>;

// Where a vector of points samples the picture.
struct Samples {
  V inside, a, b;  // a, b: fractions in [0, 1)
  VI at;           // pixels from the picture's first
};

HWY_INLINE Samples sample_points(const WarpJob& w, V x, V y) {
  const Floats d;
  const Ints di;
  const auto set = [&](float v) HWY_ATTR { return hn::Set(d, v); };
  const auto dot = [&](int k) HWY_ATTR {
    return hn::MulAdd(y, set(w.per_y[k]), hn::MulAdd(x, set(w.per_x[k]), set(w.origin[k])));
  };
  const V inverse = hn::Div(set(1), dot(2));
  V u = hn::Mul(dot(0), inverse), v = hn::Mul(dot(1), inverse);
  if (w.lens) {  // eq. 3
    const V xx = hn::Mul(u, u), yy = hn::Mul(v, v), r2 = hn::Add(xx, yy), xy2 = hn::Mul(hn::Add(u, u), v);
    const V radial = hn::MulAdd(r2, hn::MulAdd(r2, set(w.k2), set(w.k1)), set(1));
    const V xd = hn::MulAdd(u, radial, hn::MulAdd(set(w.k3), xy2, hn::Mul(set(w.k4), hn::MulAdd(set(2), xx, r2))));
    const V yd = hn::MulAdd(v, radial, hn::MulAdd(set(w.k3), hn::MulAdd(set(2), yy, r2), hn::Mul(set(w.k4), xy2)));
    u = hn::MulAdd(xd, set(w.u_scale), set(w.u_add));
    v = hn::MulAdd(yd, set(w.v_scale), set(w.v_add));
  }
  // A NaN becomes the border, inside the picture, and then compares unequal. Max and Min are not the same about NaN on
  // all machines.
  const V low = set(w.border);
  const auto clamped = [&](V p, float most) HWY_ATTR {
    return hn::Min(hn::IfThenElse(hn::Ge(p, low), p, low), set(most));
  };
  const V uc = clamped(u, w.u_max), vc = clamped(v, w.v_max);
  const VI iu = hn::ConvertTo(di, uc), iv = hn::ConvertTo(di, vc);
  return {hn::IfThenElseZero(hn::And(hn::Eq(uc, u), hn::Eq(vc, v)), set(1)), hn::Sub(uc, hn::ConvertTo(d, iu)),
          hn::Sub(vc, hn::ConvertTo(d, iv)),
          hn::Add(hn::Mul(iv, hn::Set(di, static_cast<std::int32_t>(w.stride))), iu)};
}

// Pixels -1, 0, 1, 2 of a row from the sample's.
struct Four {
  V p0, p1, p2, p3;
};

template <bool kBytes>
HWY_INLINE Four four_pixels(const WarpJob& w, const Addresses& at, std::ptrdiff_t row, bool outer) {
  const Floats d;
  const Ints di;
  if constexpr (kBytes) {  // a word is all four
    const VI word = fetch(w.bytes + row * w.stride - 1, at), low = hn::Set(di, 255);
    Four f;
    f.p1 = hn::ConvertTo(d, hn::And(hn::ShiftRight<8>(word), low));
    f.p2 = hn::ConvertTo(d, hn::And(hn::ShiftRight<16>(word), low));
    if (outer) {
      f.p0 = hn::ConvertTo(d, hn::And(word, low));
      f.p3 = hn::ConvertTo(d, hn::And(hn::ShiftRight<24>(word), low));
    }
    return f;
  } else {
    const float* base = w.image + row * w.stride;
    Four f;
    const auto pixel = [&](int i) HWY_ATTR { return hn::BitCast(d, fetch(base + i, at)); };
    f.p1 = pixel(0);
    f.p2 = pixel(1);
    if (outer) {
      f.p0 = pixel(-1);
      f.p3 = pixel(2);
    }
    return f;
  }
}

// Catmull-Rom, which keeps the contrast between pixels; bilinear sampling lowers it by up to w^2/8 at angular
// frequency w. The weights of pixels -1, 0, 1, 2 at fraction a.
HWY_INLINE Four cubic_weights(V a) {
  const Floats d;
  const V half = hn::Set(d, 0.5F), ha = hn::Mul(half, a);
  const V b = hn::Sub(hn::Set(d, 1), a), hb = hn::Mul(half, b);
  Four w;
  w.p0 = hn::Neg(hn::Mul(ha, hn::Mul(b, b)));  // -a (1-a)^2 / 2
  w.p3 = hn::Neg(hn::Mul(hb, hn::Mul(a, a)));
  const V two = hn::Set(d, 2);  // the other two follow from what reproduces straight lines
  w.p1 = hn::Add(hn::NegMulAdd(two, w.p0, b), w.p3);
  w.p2 = hn::Add(hn::NegMulAdd(two, w.p3, a), w.p0);
  return w;
}

HWY_INLINE V combined(const Four& f, const Four& w) {
  return hn::MulAdd(f.p3, w.p3, hn::MulAdd(f.p2, w.p2, hn::MulAdd(f.p1, w.p1, hn::Mul(f.p0, w.p0))));
}

template <bool kBytes, bool kCubic>
HWY_INLINE V grey_at(const WarpJob& w, const Samples& s) {
  const Addresses at(kBytes ? s.at : hn::ShiftLeft<2>(s.at));
  if constexpr (kCubic) {
    const Four across = cubic_weights(s.a), down = cubic_weights(s.b);
    const V r0 = combined(four_pixels<kBytes>(w, at, -1, true), across);
    const V r1 = combined(four_pixels<kBytes>(w, at, 0, true), across);
    const V r2 = combined(four_pixels<kBytes>(w, at, 1, true), across);
    const V r3 = combined(four_pixels<kBytes>(w, at, 2, true), across);
    return combined({r0, r1, r2, r3}, down);
  } else {
    const Four top = four_pixels<kBytes>(w, at, 0, false), bottom = four_pixels<kBytes>(w, at, 1, false);
    const V t = hn::MulAdd(s.a, hn::Sub(top.p2, top.p1), top.p1);
    const V b = hn::MulAdd(s.a, hn::Sub(bottom.p2, bottom.p1), bottom.p1);
    return hn::MulAdd(s.b, hn::Sub(b, t), t);
  }
}

template <bool kBytes, bool kCubic>
void warp_rows(const WarpJob& w, float* HWY_RESTRICT grey, float* HWY_RESTRICT inside) {
  const Floats d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  HWY_ALIGN float narrow[4 * HWY_MAX_BYTES / sizeof(float)] = {};  // of a grid narrower than a vector
  for (int row = 0; row < w.rows; ++row) {
    const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(row) * w.columns;
    const V y = hn::Set(d, w.first_y + static_cast<float>(row) * w.step);
    for (int i = 0; i < w.columns; i += lanes) {
      const bool is_narrow = w.columns < lanes;
      const int at = is_narrow ? 0 : std::min(i, w.columns - lanes);  // the last one overlaps that before
      const auto n = static_cast<std::size_t>(std::min(lanes, w.columns));
      V px, py;
      if (w.bent_x && is_narrow) {
        std::copy_n(w.bent_x + first, n, narrow);
        std::copy_n(w.bent_y + first, n, narrow + lanes);
        px = hn::Load(d, narrow), py = hn::Load(d, narrow + lanes);
      } else if (w.bent_x) {
        px = hn::LoadU(d, w.bent_x + first + at), py = hn::LoadU(d, w.bent_y + first + at);
      } else {
        px = hn::MulAdd(hn::Iota(d, static_cast<float>(at)), hn::Set(d, w.step), hn::Set(d, w.first_x)), py = y;
      }
      const Samples s = sample_points(w, px, py);
      V g = grey_at<kBytes, kCubic>(w, s);
      if (!inside) g = hn::IfThenElse(hn::Gt(s.inside, hn::Zero(d)), g, hn::Set(d, kOutside));
      if (is_narrow) {
        hn::Store(g, d, narrow), hn::Store(s.inside, d, narrow + lanes);
        std::copy_n(narrow, n, grey + first);
        if (inside) std::copy_n(narrow + lanes, n, inside + first);
      } else {
        hn::StoreU(g, d, grey + first + at);
        if (inside) hn::StoreU(s.inside, d, inside + first + at);
      }
    }
  }
}

void warp_any(const WarpJob& w, float* grey, float* inside) {
  if (w.bytes)
    w.cubic ? warp_rows<true, true>(w, grey, inside) : warp_rows<true, false>(w, grey, inside);
  else
    w.cubic ? warp_rows<false, true>(w, grey, inside) : warp_rows<false, false>(w, grey, inside);
}

}  // namespace HWY_NAMESPACE
}  // namespace heartservo::tracking::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace heartservo::tracking::simd {
HWY_EXPORT(warp_any);
void warp_grid(const WarpJob& job, float* grey, float* inside) {
  HWY_DYNAMIC_DISPATCH(warp_any)(job, grey, inside);
}
}  // namespace heartservo::tracking::simd
#endif
