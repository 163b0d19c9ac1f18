#include "tracking/planar/simd/bend_kernel.hpp"

#include <algorithm>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tracking/planar/simd/bend_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace heartservo::tracking::simd {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::ScalableTag<float>;
using V = hn::Vec<Floats>;

constexpr int kRowsAtOnce = 32;
constexpr int kKept = 6;  // values per point: gx, gy, grey, then the same weighted

// Sums over some rows of a vector of columns, still apart by column.
struct Columns {
  V squares[6][6], singles[3][3], residuals[3][3], weight, residual;
};

HWY_INLINE void clear(Columns& c) {
  const V zero = hn::Zero(Floats());
  for (auto& quantity : c.squares) std::fill_n(quantity, 6, zero);
  for (auto& quantity : c.singles) std::fill_n(quantity, 3, zero);
  for (auto& quantity : c.residuals) std::fill_n(quantity, 3, zero);
  c.weight = c.residual = zero;
}

// Gradients, and what is weighted; sums that need no products of splines.
HWY_INLINE void first_loop(const BendCell& cell, std::ptrdiff_t at, int first_row, int rows, int count, float* kept,
                           Columns& c) {
  const Floats d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto mask = hn::FirstN(d, static_cast<std::size_t>(count));
  const V share = hn::Set(d, cell.share), half = hn::Set(d, cell.half_gain), gain = hn::Set(d, cell.gain);
  V x0 = c.residuals[0][0], x1 = c.residuals[0][1], x2 = c.residuals[0][2];
  V y0 = c.residuals[1][0], y1 = c.residuals[1][1], y2 = c.residuals[1][2];
  V g0 = c.residuals[2][0], g1 = c.residuals[2][1], g2 = c.residuals[2][2];
  V ws = c.weight, rs = c.residual;
  for (int row = 0; row < rows; ++row, at += cell.stride) {
    const float* g = cell.grey + at;
    const V half_gain = hn::Mul(half, hn::Add(gain, hn::MaskedLoad(mask, d, cell.gain_offset + at)));
    const V right = hn::MaskedLoad(mask, d, g + 1), left = hn::MaskedLoad(mask, d, g - 1);
    const V down = hn::MaskedLoad(mask, d, g + cell.stride), up = hn::MaskedLoad(mask, d, g - cell.stride);
    const V gx = hn::MulAdd(half_gain, hn::Sub(right, left), hn::Mul(share, hn::MaskedLoad(mask, d, cell.gradient_x + at)));
    const V gy = hn::MulAdd(half_gain, hn::Sub(down, up), hn::Mul(share, hn::MaskedLoad(mask, d, cell.gradient_y + at)));
    const V grey = hn::MaskedLoad(mask, d, g), w = hn::MaskedLoad(mask, d, cell.weight + at);
    const V wr = hn::Mul(w, hn::MaskedLoad(mask, d, cell.residual + at));
    const float* by = cell.along_y + 3 * (first_row + row);
    const V b0 = hn::Set(d, by[0]), b1 = hn::Set(d, by[1]), b2 = hn::Set(d, by[2]);
    V p = hn::Mul(gx, wr);
    x0 = hn::MulAdd(p, b0, x0), x1 = hn::MulAdd(p, b1, x1), x2 = hn::MulAdd(p, b2, x2);
    p = hn::Mul(gy, wr);
    y0 = hn::MulAdd(p, b0, y0), y1 = hn::MulAdd(p, b1, y1), y2 = hn::MulAdd(p, b2, y2);
    p = hn::Mul(grey, wr);
    g0 = hn::MulAdd(p, b0, g0), g1 = hn::MulAdd(p, b1, g1), g2 = hn::MulAdd(p, b2, g2);
    ws = hn::Add(ws, w), rs = hn::Add(rs, wr);
    float* k = kept + row * kKept * lanes;
    hn::Store(gx, d, k), hn::Store(gy, d, k + lanes), hn::Store(grey, d, k + 2 * lanes);
    hn::Store(hn::Mul(w, gx), d, k + 3 * lanes), hn::Store(hn::Mul(w, gy), d, k + 4 * lanes);
    hn::Store(hn::Mul(w, grey), d, k + 5 * lanes);
  }
  c.residuals[0][0] = x0, c.residuals[0][1] = x1, c.residuals[0][2] = x2;
  c.residuals[1][0] = y0, c.residuals[1][1] = y1, c.residuals[1][2] = y2;
  c.residuals[2][0] = g0, c.residuals[2][1] = g1, c.residuals[2][2] = g2;
  c.weight = ws, c.residual = rs;
}

// Two quantities, products of kept values a b and a2 b2, times the six products of splines along y.
HWY_INLINE void two_squares(const float* kept, const float* pairs, int rows, int a, int b, int a2, int b2, V* first,
                            V* second) {
  const Floats d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  V s0 = first[0], s1 = first[1], s2 = first[2], s3 = first[3], s4 = first[4], s5 = first[5];
  V t0 = second[0], t1 = second[1], t2 = second[2], t3 = second[3], t4 = second[4], t5 = second[5];
  for (int row = 0; row < rows; ++row, kept += kKept * lanes, pairs += 6) {
    const V p = hn::Mul(hn::Load(d, kept + a * lanes), hn::Load(d, kept + b * lanes));
    const V q = hn::Mul(hn::Load(d, kept + a2 * lanes), hn::Load(d, kept + b2 * lanes));
    V y = hn::Set(d, pairs[0]);
    s0 = hn::MulAdd(p, y, s0), t0 = hn::MulAdd(q, y, t0), y = hn::Set(d, pairs[1]);
    s1 = hn::MulAdd(p, y, s1), t1 = hn::MulAdd(q, y, t1), y = hn::Set(d, pairs[2]);
    s2 = hn::MulAdd(p, y, s2), t2 = hn::MulAdd(q, y, t2), y = hn::Set(d, pairs[3]);
    s3 = hn::MulAdd(p, y, s3), t3 = hn::MulAdd(q, y, t3), y = hn::Set(d, pairs[4]);
    s4 = hn::MulAdd(p, y, s4), t4 = hn::MulAdd(q, y, t4), y = hn::Set(d, pairs[5]);
    s5 = hn::MulAdd(p, y, s5), t5 = hn::MulAdd(q, y, t5);
  }
  first[0] = s0, first[1] = s1, first[2] = s2, first[3] = s3, first[4] = s4, first[5] = s5;
  second[0] = t0, second[1] = t1, second[2] = t2, second[3] = t3, second[4] = t4, second[5] = t5;
}

HWY_INLINE void singles(const float* kept, const float* along_y, int rows, Columns& c) {
  const Floats d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int quantity = 0; quantity < 3; ++quantity) {
    V* s = c.singles[quantity];
    V s0 = s[0], s1 = s[1], s2 = s[2];
    for (int row = 0; row < rows; ++row) {
      const V p = hn::Load(d, kept + (row * kKept + 3 + quantity) * lanes);
      const float* by = along_y + 3 * row;
      s0 = hn::MulAdd(p, hn::Set(d, by[0]), s0), s1 = hn::MulAdd(p, hn::Set(d, by[1]), s1);
      s2 = hn::MulAdd(p, hn::Set(d, by[2]), s2);
    }
    s[0] = s0, s[1] = s1, s[2] = s2;
  }
}

HWY_INLINE float total(V v) { return hn::GetLane(hn::SumOfLanes(Floats(), v)); }

// Times the splines along x, added up over the columns.
HWY_INLINE void add_columns(const Columns& c, const float* bx, std::ptrdiff_t stride, BendSums& out) {
  const Floats d;
  const V b[3] = {hn::LoadU(d, bx), hn::LoadU(d, bx + stride), hn::LoadU(d, bx + 2 * stride)};
  const V bb[6] = {hn::Mul(b[0], b[0]), hn::Mul(b[0], b[1]), hn::Mul(b[0], b[2]),
                   hn::Mul(b[1], b[1]), hn::Mul(b[1], b[2]), hn::Mul(b[2], b[2])};
  for (int q = 0; q < 6; ++q)
    for (int y = 0; y < 6; ++y)
      for (int x = 0; x < 6; ++x) out.squares[q][y][x] += total(hn::Mul(c.squares[q][y], bb[x]));
  for (int q = 0; q < 3; ++q)
    for (int y = 0; y < 3; ++y)
      for (int x = 0; x < 3; ++x) {
        out.singles[q][y][x] += total(hn::Mul(c.singles[q][y], b[x]));
        out.residuals[q][y][x] += total(hn::Mul(c.residuals[q][y], b[x]));
      }
  out.weight += total(c.weight);
  out.residual += total(c.residual);
}

void add_cell(const BendCell& cell, BendSums& out) {
  const Floats d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  HWY_ALIGN float kept[kRowsAtOnce * kKept * HWY_MAX_BYTES / sizeof(float)];
  float pairs[kRowsAtOnce * 6];
  std::memset(&out, 0, sizeof(out));
  for (int column = 0; column < cell.columns; column += lanes) {
    Columns c;
    clear(c);
    for (int row = 0; row < cell.rows; row += kRowsAtOnce) {
      const int rows = std::min(kRowsAtOnce, cell.rows - row);
      const float* along_y = cell.along_y + 3 * row;
      for (int i = 0; i < rows; ++i) {
        const float *y = along_y + 3 * i;
        float* p = pairs + 6 * i;
        p[0] = y[0] * y[0], p[1] = y[0] * y[1], p[2] = y[0] * y[2];
        p[3] = y[1] * y[1], p[4] = y[1] * y[2], p[5] = y[2] * y[2];
      }
      first_loop(cell, row * cell.stride + column, row, rows, std::min(lanes, cell.columns - column), kept, c);
      two_squares(kept, pairs, rows, 0, 3, 1, 3, c.squares[0], c.squares[1]);
      two_squares(kept, pairs, rows, 2, 3, 1, 4, c.squares[2], c.squares[3]);
      two_squares(kept, pairs, rows, 2, 4, 2, 5, c.squares[4], c.squares[5]);
      singles(kept, along_y, rows, c);
    }
    add_columns(c, cell.along_x + column, cell.along_stride, out);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace heartservo::tracking::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace heartservo::tracking::simd {
HWY_EXPORT(add_cell);
void add_bend_cell(const BendCell& cell, BendSums& out) { HWY_DYNAMIC_DISPATCH(add_cell)(cell, out); }
}  // namespace heartservo::tracking::simd
#endif
