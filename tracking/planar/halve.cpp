#include "tracking/planar/halve.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

#include "tracking/settings/target_clones.hpp"

namespace heartservo::tracking {

namespace {

// "dcb|abcd|cba"
int mirrored(int i, int n) {
  if (n == 1) return 0;
  while (i < 0 || i >= n) i = i < 0 ? -i : 2 * (n - 1) - i;
  return i;
}

template <class Pixel>
inline __attribute__((always_inline)) void add_across(const Pixel* __restrict from, int first, int last,
                                                      float* __restrict to) {
#pragma omp simd
  for (int x = first; x < last; ++x) {
    const Pixel* p = from + 2 * x;
    to[x] = 6 * static_cast<float>(p[0]) + 4 * (static_cast<float>(p[-1]) + static_cast<float>(p[1])) +
            static_cast<float>(p[-2]) + static_cast<float>(p[2]);
  }
}
HEARTSERVO_SIMD void across(const float* from, int first, int last, float* to) { add_across(from, first, last, to); }
HEARTSERVO_SIMD void across(const std::uint8_t* from, int first, int last, float* to) {
  add_across(from, first, last, to);
}

HEARTSERVO_SIMD void down(const std::array<const float*, 5>& rows, int n, float* __restrict to) {
  const float *a = rows[0], *b = rows[1], *c = rows[2], *d = rows[3], *e = rows[4];
#pragma omp simd
  for (int x = 0; x < n; ++x) to[x] = (6 * c[x] + 4 * (b[x] + d[x]) + a[x] + e[x]) * (1.0F / 256);
}

template <class Pixel>
void halve_rows(const cv::Mat& from, cv::Mat& to, std::vector<float>& scratch) {
  const int n = to.cols;
  scratch.resize(std::max(scratch.size(), 5 * static_cast<std::size_t>(n)));
  std::array<int, 5> holds;  // the row of the picture that a part of the scratch was made from
  holds.fill(-1);
  const auto row_of = [&](int v) {
    const auto slot = static_cast<std::size_t>(v % 5);
    float* const row = scratch.data() + slot * static_cast<std::size_t>(n);
    if (holds[slot] == v) return row;
    holds[slot] = v;
    const Pixel* p = from.ptr<Pixel>(v);
    const int last = std::clamp((from.cols - 1) / 2, 1, n);
    across(p, 1, last, row);
    const auto at_border = [&](int x) {
      const auto pixel = [&](int i) { return static_cast<float>(p[mirrored(2 * x + i, from.cols)]); };
      row[x] = 6 * pixel(0) + 4 * (pixel(-1) + pixel(1)) + pixel(-2) + pixel(2);
    };
    at_border(0);
    for (int x = last; x < n; ++x) at_border(x);
    return row;
  };
  for (int y = 0; y < to.rows; ++y) {
    std::array<const float*, 5> rows;
    for (int k = -2; k <= 2; ++k) rows[static_cast<std::size_t>(k + 2)] = row_of(mirrored(2 * y + k, from.rows));
    down(rows, n, to.ptr<float>(y));
  }
}

}  // namespace

void halve(const cv::Mat& from, cv::Mat& to, std::vector<float>& scratch) {
  if (from.depth() == CV_8U)
    halve_rows<std::uint8_t>(from, to, scratch);
  else
    halve_rows<float>(from, to, scratch);
}

}  // namespace heartservo::tracking
