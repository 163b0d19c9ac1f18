#include "tracking/landmark/simd/dense_kernel.hpp"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tracking/landmark/simd/dense_kernel.cpp"
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
using M = hn::Mask<Floats>;

HWY_INLINE V set(float v) { return hn::Set(Floats(), v); }

// a . (x, y, 1)
HWY_INLINE V with_ray(const float* a, V x, V y) {
  return hn::MulAdd(set(a[0]), x, hn::MulAdd(set(a[1]), y, set(a[2])));
}

// Where rays meet the plate.
struct Meeting {
  V x, y;  // half sides
  V slant, distance;  // 1 / (normal . ray); the meeting is at distance * ray
  V right_ray, down_ray;
  M covered;
};

HWY_INLINE Meeting meet(const DenseJob& job, V rx, V ry) {
  const auto dot = [](const float* a, const float* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
  Meeting m;
  m.slant = hn::Div(set(1), with_ray(job.normal, rx, ry));
  m.distance = hn::Mul(set(dot(job.normal, job.centre)), m.slant);
  m.right_ray = with_ray(job.right, rx, ry), m.down_ray = with_ray(job.down, rx, ry);
  const V per_side = set(1 / job.half_side_m);
  m.x = hn::Mul(hn::Sub(hn::Mul(m.distance, m.right_ray), set(dot(job.right, job.centre))), per_side);
  m.y = hn::Mul(hn::Sub(hn::Mul(m.distance, m.down_ray), set(dot(job.down, job.centre))), per_side);
  m.covered = hn::And(hn::Lt(hn::Abs(m.x), set(job.reach)), hn::Lt(hn::Abs(m.y), set(job.reach)));
  return m;
}

// Catmull-Rom weights of the nodes -1, 0, 1, 2 at the fraction f, and their derivatives.
struct Weights {
  V w[4], d[4];
};
HWY_INLINE Weights weights_at(V f) {
  const V half = set(0.5F), hf = hn::Mul(half, f), f2 = hn::Mul(f, f);
  Weights k;
  k.w[0] = hn::Mul(hf, hn::MulAdd(f, hn::Sub(set(2), f), set(-1)));
  k.w[1] = hn::MulAdd(hn::Mul(half, f2), hn::MulAdd(set(3), f, set(-5)), set(1));
  k.w[2] = hn::Mul(hf, hn::MulAdd(f, hn::NegMulAdd(set(3), f, set(4)), set(1)));
  k.w[3] = hn::Mul(hn::Mul(half, f2), hn::Sub(f, set(1)));
  k.d[0] = hn::MulAdd(f, hn::NegMulAdd(set(1.5F), f, set(2)), set(-0.5F));
  k.d[1] = hn::Mul(f, hn::MulAdd(set(4.5F), f, set(-5)));
  k.d[2] = hn::MulAdd(f, hn::NegMulAdd(set(4.5F), f, set(4)), set(0.5F));
  k.d[3] = hn::Mul(f, hn::MulAdd(set(1.5F), f, set(-1)));
  return k;
}

// Value and slopes per unit of the plate's coordinates.
struct Slopes {
  V value, dx, dy;
};
struct PlateSample {
  Slopes grey, softening;
};

HWY_INLINE PlateSample sample(const DenseJob& job, V x, V y) {
  const Floats d;
  const Ints di;
  constexpr float kScale = 0.5F * LandmarkTemplate::kSize, kNode = 1.0F / LandmarkTemplate::kPackedPerGrey;
  const auto node = [&](V at, V& fraction) HWY_ATTR {
    const V s = hn::MulAdd(hn::Add(at, set(1)), set(kScale), set(-0.5F));
    // what is not covered, or NaN, reads some node
    const V c = hn::Min(hn::IfThenElse(hn::Ge(s, set(1)), s, set(1)), set(LandmarkTemplate::kSize - 2.01F));
    const VI i = hn::ConvertTo(di, c);
    fraction = hn::Sub(s, hn::ConvertTo(d, i));
    return i;
  };
  V f, g;
  const VI i = node(x, f), j = node(y, g);
  const Addresses at(hn::ShiftLeft<2>(hn::Add(hn::Mul(j, hn::Set(di, LandmarkTemplate::kSize)), i)));
  const Weights across = weights_at(f), down = weights_at(g);
  const V zero = hn::Zero(d);
  PlateSample s{{zero, zero, zero}, {zero, zero, zero}};
  for (int row = 0; row < 4; ++row) {
    V t = zero, tx = zero, soft = zero, soft_x = zero;
    for (int k = 0; k < 4; ++k) {
      const VI word = fetch(job.nodes + (row - 1) * LandmarkTemplate::kSize + (k - 1), at);
      const V grey = hn::ConvertTo(d, hn::ShiftRight<16>(hn::ShiftLeft<16>(word)));
      const V softening = hn::ConvertTo(d, hn::ShiftRight<16>(word));
      t = hn::MulAdd(grey, across.w[k], t), tx = hn::MulAdd(grey, across.d[k], tx);
      soft = hn::MulAdd(softening, across.w[k], soft), soft_x = hn::MulAdd(softening, across.d[k], soft_x);
    }
    s.grey.value = hn::MulAdd(t, down.w[row], s.grey.value), s.grey.dx = hn::MulAdd(tx, down.w[row], s.grey.dx);
    s.grey.dy = hn::MulAdd(t, down.d[row], s.grey.dy);
    s.softening.value = hn::MulAdd(soft, down.w[row], s.softening.value);
    s.softening.dx = hn::MulAdd(soft_x, down.w[row], s.softening.dx);
    s.softening.dy = hn::MulAdd(soft, down.d[row], s.softening.dy);
  }
  const auto scale = [&](Slopes& p) HWY_ATTR {
    p.value = hn::Mul(p.value, set(kNode));
    p.dx = hn::Mul(p.dx, set(kNode * kScale)), p.dy = hn::Mul(p.dy, set(kNode * kScale));
  };
  scale(s.grey), scale(s.softening);
  return s;
}

HWY_INLINE V light_at(const float* l, V x, V y) {
  const V with_x = hn::MulAdd(x, hn::MulAdd(set(l[3]), x, hn::MulAdd(set(l[4]), y, set(l[1]))), set(l[0]));
  return hn::MulAdd(y, hn::MulAdd(set(l[5]), y, set(l[2])), with_x);
}

HWY_INLINE V predicted(const DenseJob& job, const PlateSample& s, V L) {
  return hn::MulAdd(L, s.grey.value, hn::MulAdd(set(job.light[6]), s.softening.value, set(job.light[7])));
}

void collect(const DenseJob& job, const float* rays, const unsigned char* grey, std::size_t n, float saturated,
             float* ray_x, float* ray_y, float* out_grey, std::size_t& covered, std::size_t& count) {
  const Floats d;
  const hn::Rebind<std::uint8_t, Floats> d8;
  const Ints di;
  const std::size_t lanes = hn::Lanes(d);
  for (std::size_t i = 0; i < n; i += lanes) {
    HWY_ALIGN float x[HWY_MAX_BYTES / sizeof(float)] = {}, y[HWY_MAX_BYTES / sizeof(float)] = {};
    HWY_ALIGN std::uint8_t g[HWY_MAX_BYTES / sizeof(float)] = {};
    const std::size_t some = std::min(lanes, n - i);
    for (std::size_t k = 0; k < some; ++k) x[k] = rays[2 * (i + k)], y[k] = rays[2 * (i + k) + 1];
    std::copy_n(grey + i, some, g);
    const V rx = hn::Load(d, x), ry = hn::Load(d, y);
    const M on_plate = hn::And(meet(job, rx, ry).covered, hn::FirstN(d, some));  // NaN rays compare false
    const V level = hn::ConvertTo(d, hn::PromoteTo(di, hn::Load(d8, g)));
    const M use = hn::And(on_plate, hn::And(hn::Gt(level, hn::Zero(d)), hn::Lt(level, set(saturated))));
    covered += hn::CountTrue(d, on_plate);
    hn::CompressStore(rx, use, d, ray_x + count);
    hn::CompressStore(ry, use, d, ray_y + count);
    count += hn::CompressStore(level, use, d, out_grey + count);
  }
}

void sample_all(const DenseJob& job, const DensePixels& p) {
  const Floats d;
  for (std::size_t i = 0; i < p.n; i += hn::Lanes(d)) {
    const Meeting m = meet(job, hn::LoadU(d, p.ray_x + i), hn::LoadU(d, p.ray_y + i));
    hn::StoreU(hn::IfThenElseZero(m.covered, sample(job, m.x, m.y).grey.value), d, p.residual + i);
  }
}

void predict_all(const DenseJob& job, const DensePixels& p) {
  const Floats d;
  for (std::size_t i = 0; i < p.n; i += hn::Lanes(d)) {
    const Meeting m = meet(job, hn::LoadU(d, p.ray_x + i), hn::LoadU(d, p.ray_y + i));
    const V grey = predicted(job, sample(job, m.x, m.y), light_at(job.light, m.x, m.y));
    hn::StoreU(hn::IfThenElseZero(m.covered, hn::Sub(hn::LoadU(d, p.grey + i), grey)), d, p.residual + i);
    hn::StoreU(hn::IfThenElseZero(m.covered, hn::LoadU(d, p.weight + i)), d, p.weight + i);
  }
}

constexpr std::size_t kBlock = 128;  // pixels whose rows stay in the first-level cache

// Rows of a vector of pixels, times the root of the weight, into rows[k * kBlock].
HWY_INLINE void write_rows(const DenseJob& job, const DensePixels& p, std::size_t i, float* rows) {
  const Floats d;
  const V rx = hn::LoadU(d, p.ray_x + i), ry = hn::LoadU(d, p.ray_y + i);
  const Meeting m = meet(job, rx, ry);
  const PlateSample s = sample(job, m.x, m.y);
  const float* l = job.light;
  const V L = light_at(l, m.x, m.y);
  const V residual = hn::IfThenElseZero(m.covered, hn::Sub(hn::LoadU(d, p.grey + i), predicted(job, s, L)));
  const V weight = hn::IfThenElseZero(m.covered, hn::LoadU(d, p.weight + i));
  hn::StoreU(residual, d, p.residual + i);
  hn::StoreU(weight, d, p.weight + i);
  const V root = hn::Sqrt(weight);
  const V L_x = hn::MulAdd(set(2 * l[3]), m.x, hn::MulAdd(set(l[4]), m.y, set(l[1])));
  const V L_y = hn::MulAdd(set(2 * l[5]), m.y, hn::MulAdd(set(l[4]), m.x, set(l[2])));
  const V per_side = hn::Mul(root, set(1 / job.half_side_m));
  const V I_x = hn::Mul(per_side, hn::MulAdd(L, s.grey.dx, hn::MulAdd(L_x, s.grey.value, hn::Mul(set(l[6]), s.softening.dx))));
  const V I_y = hn::Mul(per_side, hn::MulAdd(L, s.grey.dy, hn::MulAdd(L_y, s.grey.value, hn::Mul(set(l[6]), s.softening.dy))));
  // g = I_x (right . ray slant normal - right) + I_y (down . ray slant normal - down)
  const V along = hn::Mul(m.slant, hn::MulAdd(I_x, m.right_ray, hn::Mul(I_y, m.down_ray)));
  V g[3];
  for (int k = 0; k < 3; ++k)
    g[k] = hn::NegMulAdd(I_x, set(job.right[k]), hn::NegMulAdd(I_y, set(job.down[k]), hn::Mul(along, set(job.normal[k]))));
  const V ax = hn::MulAdd(m.distance, rx, set(-job.centre[0])), ay = hn::MulAdd(m.distance, ry, set(-job.centre[1])),
          az = hn::Sub(m.distance, set(job.centre[2]));
  const V T = hn::Mul(root, s.grey.value), xT = hn::Mul(m.x, T), yT = hn::Mul(m.y, T);
  const V row[kDenseRow] = {g[0],
                            g[1],
                            g[2],
                            hn::Sub(hn::Mul(ay, g[2]), hn::Mul(az, g[1])),
                            hn::Sub(hn::Mul(az, g[0]), hn::Mul(ax, g[2])),
                            hn::Sub(hn::Mul(ax, g[1]), hn::Mul(ay, g[0])),
                            T,
                            xT,
                            yT,
                            hn::Mul(m.x, xT),
                            hn::Mul(m.y, xT),
                            hn::Mul(m.y, yT),
                            hn::Mul(root, s.softening.value),
                            root,
                            hn::Mul(root, residual)};
  // a weight of 0 may stand beside what is not finite
  const M counts = hn::Gt(weight, hn::Zero(d));
  for (std::size_t k = 0; k < kDenseRow; ++k) hn::Store(hn::IfThenElseZero(counts, row[k]), d, rows + k * kBlock);
}

// Products of rows a ... a + 2 with b ... b + 4.
HWY_INLINE void add_tile(const float* rows, std::size_t n, std::size_t a, std::size_t b, double* sums) {
  const Floats d;
  V s[3][5];
  for (auto& line : s) std::fill_n(line, 5, hn::Zero(d));
  for (std::size_t i = 0; i < n; i += hn::Lanes(d)) {
    const float* p = rows + i;
    const V a0 = hn::Load(d, p + a * kBlock), a1 = hn::Load(d, p + (a + 1) * kBlock), a2 = hn::Load(d, p + (a + 2) * kBlock);
    for (std::size_t k = 0; k < 5; ++k) {
      const V other = hn::Load(d, p + (b + k) * kBlock);
      s[0][k] = hn::MulAdd(a0, other, s[0][k]);
      s[1][k] = hn::MulAdd(a1, other, s[1][k]);
      s[2][k] = hn::MulAdd(a2, other, s[2][k]);
    }
  }
  for (std::size_t j = 0; j < 3; ++j)
    for (std::size_t k = 0; k < 5; ++k)
      sums[(a + j) * kDenseRow + b + k] += static_cast<double>(hn::GetLane(hn::SumOfLanes(d, s[j][k])));
}

void add_all(const DenseJob& job, const DensePixels& p, double* sums) {
  const Floats d;
  HWY_ALIGN float rows[kDenseRow * kBlock];
  for (std::size_t begin = 0; begin < p.n; begin += kBlock) {
    const std::size_t n = std::min(kBlock, p.n - begin);
    for (std::size_t i = 0; i < n; i += hn::Lanes(d)) write_rows(job, p, begin + i, rows + i);
    for (std::size_t a = 0; a < kDenseRow; a += 3)
      for (std::size_t b = 0; b < kDenseRow; b += 5)
        if (b + 4 >= a) add_tile(rows, n, a, b, sums);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace heartservo::tracking::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace heartservo::tracking::simd {

HWY_EXPORT(collect);
HWY_EXPORT(sample_all);
HWY_EXPORT(predict_all);
HWY_EXPORT(add_all);

DenseJob dense_job(const LandmarkTemplate& plate, const PlateView& view, const DenseLight& light) {
  DenseJob job;
  job.nodes = plate.packed();
  job.reach = static_cast<float>(plate.reach());
  const auto copy = [](const Eigen::Vector3d& from, float* to) {
    for (int i = 0; i < 3; ++i) to[i] = static_cast<float>(from(i));
  };
  copy(view.right, job.right), copy(view.down, job.down), copy(view.normal, job.normal), copy(view.centre, job.centre);
  job.half_side_m = static_cast<float>(view.half_side_m);
  for (int i = 0; i < kLightParameters; ++i) job.light[i] = static_cast<float>(light(i));
  return job;
}

std::size_t collect_row(const DenseJob& job, const float* rays, const unsigned char* grey, std::size_t n,
                        float saturated, float* ray_x, float* ray_y, float* out_grey, std::size_t& covered) {
  std::size_t count = 0;
  HWY_DYNAMIC_DISPATCH(collect)(job, rays, grey, n, saturated, ray_x, ray_y, out_grey, covered, count);
  return count;
}

void sample_plate(const DenseJob& job, const DensePixels& pixels) { HWY_DYNAMIC_DISPATCH(sample_all)(job, pixels); }
void predict(const DenseJob& job, const DensePixels& pixels) { HWY_DYNAMIC_DISPATCH(predict_all)(job, pixels); }
void add_normal(const DenseJob& job, const DensePixels& pixels, double* sums) {
  HWY_DYNAMIC_DISPATCH(add_all)(job, pixels, sums);
}

}  // namespace heartservo::tracking::simd
#endif
