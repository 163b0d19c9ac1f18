#include "tracking/texture/matrices.hpp"

#include <algorithm>

#include "tracking/settings/target_clones.hpp"

namespace heartservo::tracking {

void CooccurrenceMatrix::reset(int level_count) {
  levels = level_count;
  stride = level_count + 1;
  counts.assign(static_cast<std::size_t>(stride * stride), 0);
}

bool CooccurrenceMatrix::operator==(const CooccurrenceMatrix& other) const {
  if (levels != other.levels) return false;
  for (int i = 0; i < levels; ++i)
    if (!std::equal(row(i), row(i) + levels, other.row(i))) return false;
  return true;
}

void RunLengthMatrix::reset(int level_count, int longest_run) {
  levels = level_count;
  stride = longest_run + 1;
  counts.assign(static_cast<std::size_t>(level_count + 1) * static_cast<std::size_t>(stride), 0);
  if (longest != longest_run) {
    longest = longest_run;
    inverse_square.assign(static_cast<std::size_t>(stride), 0);
    for (std::size_t n = 1; n < inverse_square.size(); ++n)
      inverse_square[n] = 1 / (static_cast<double>(n) * static_cast<double>(n));
  }
}

bool RunLengthMatrix::operator==(const RunLengthMatrix& other) const {
  if (levels != other.levels || longest != other.longest) return false;
  for (int i = 0; i < levels; ++i)
    if (!std::equal(row(i) + 1, row(i) + stride, other.row(i) + 1)) return false;
  return true;
}

void LevelHistogram::reset(int level_count) {
  levels = level_count;
  counts.assign(static_cast<std::size_t>(level_count) + 1, 0);
}

bool LevelHistogram::operator==(const LevelHistogram& other) const {
  return levels == other.levels && std::equal(counts.begin(), counts.begin() + levels, other.counts.begin());
}

namespace {

HEARTSERVO_SIMD void add_to(std::uint32_t* __restrict sum, const std::uint32_t* __restrict term, std::size_t n) {
  for (std::size_t i = 0; i < n; ++i) sum[i] += term[i];
}

}  // namespace

void MatrixBuilder::build(const LevelRegion& region, int distance, TextureMatrices& out, unsigned directions) {
  out.pairs.reset(region.levels);
  out.runs.reset(region.levels, std::max(region.width, region.height));
  out.histogram.reset(region.levels);
  for (auto& table : pair_tables_) table.assign(out.pairs.counts.size(), 0);
  for (auto& table : run_tables_) table.assign(out.runs.counts.size(), 0);
  for (auto& open : open_runs_) open.resize(std::max(open.size(), static_cast<std::size_t>(region.width)));
  if (region.width <= 0 || region.height <= 0) return;

  for (int y = 0; y < region.height; ++y)
    for (int x = 0; x < region.width; ++x) ++out.histogram.counts[region.row(y)[x]];
  count_pairs(region, distance);
  count_runs(region, out.runs.stride);

  auto& one_way = pair_tables_[0];  // becomes the sum over the wanted directions
  if (!(directions & DIRECTION_0)) std::fill(one_way.begin(), one_way.end(), 0);
  for (std::size_t k = 0; k < 4; ++k) {
    if (!(directions & (1u << k))) continue;
    if (k > 0) add_to(one_way.data(), pair_tables_[k].data(), one_way.size());
    add_to(out.runs.counts.data(), run_tables_[k].data(), run_tables_[k].size());
  }
  const auto n = static_cast<std::size_t>(out.pairs.stride);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) out.pairs.counts[i * n + j] = one_way[i * n + j] + one_way[j * n + i];
}

void MatrixBuilder::count_pairs(const LevelRegion& region, int d) {
  const int w = region.width, h = region.height;
  const auto stride = static_cast<std::size_t>(region.levels) + 1;
  std::uint32_t *right = pair_tables_[0].data(), *up_right = pair_tables_[1].data(), *down = pair_tables_[2].data(),
                *down_right = pair_tables_[3].data();
  for (int y = 0; y < h; ++y) {
    const std::uint8_t* q = region.row(y);
    if (y + d >= h) {
      for (int x = 0; x + d < w; ++x) ++right[q[x] * stride + q[x + d]];
      continue;
    }
    const std::uint8_t* below = region.row(y + d);
    for (int x = 0; x < std::min(d, w); ++x) {
      if (x + d < w) {
        ++right[q[x] * stride + q[x + d]];
        ++down_right[q[x] * stride + below[x + d]];
      }
      ++down[q[x] * stride + below[x]];
    }
    for (int x = d; x < w - d; ++x) {
      const std::size_t row = q[x] * stride;
      ++right[row + q[x + d]];
      ++down[row + below[x]];
      ++down_right[row + below[x + d]];
      ++up_right[row + below[x - d]];
    }
    for (int x = std::max(d, w - d); x < w; ++x) {
      ++down[q[x] * stride + below[x]];
      ++up_right[q[x] * stride + below[x - d]];
    }
  }
}

namespace {

// The run in `cell` either goes on with the next pixel or ends: counted where it ends, without a branch.
inline std::uint32_t next_cell(std::uint32_t* table, std::uint32_t cell, bool goes_on, std::uint32_t fresh) {
  table[cell] += goes_on ? 0 : 1;
  return goes_on ? cell + 1 : fresh;
}

}  // namespace

void MatrixBuilder::count_runs(const LevelRegion& region, int stride) {
  const int w = region.width, h = region.height;
  std::uint32_t *flat = run_tables_[0].data(), *rising = run_tables_[1].data(), *steep = run_tables_[2].data(),
                *falling = run_tables_[3].data();
  std::uint32_t *open_rising = open_runs_[0].data(), *open_steep = open_runs_[1].data(),
                *open_falling = open_runs_[2].data();
  const auto fresh_cell = [stride](std::uint8_t level) {
    return static_cast<std::uint32_t>(level) * static_cast<std::uint32_t>(stride) + 1;
  };
  for (int y = 0; y < h; ++y) {
    const std::uint8_t *q = region.row(y), *above = y > 0 ? region.row(y - 1) : nullptr;
    std::uint32_t open_flat = fresh_cell(q[0]);
    if (!above) {
      for (int x = 0; x < w; ++x) {
        const std::uint32_t fresh = fresh_cell(q[x]);
        if (x > 0) open_flat = next_cell(flat, open_flat, q[x] == q[x - 1], fresh);
        open_rising[x] = open_steep[x] = open_falling[x] = fresh;
      }
    } else {
      std::uint32_t up_left = open_falling[0];  // of the row above: overwritten as we go
      open_falling[0] = fresh_cell(q[0]);
      open_steep[0] = next_cell(steep, open_steep[0], q[0] == above[0], fresh_cell(q[0]));
      open_rising[0] = w > 1 ? next_cell(rising, open_rising[1], q[0] == above[1], fresh_cell(q[0])) : fresh_cell(q[0]);
      for (int x = 1; x < w - 1; ++x) {
        const std::uint8_t level = q[x];
        const std::uint32_t fresh = fresh_cell(level);
        open_flat = next_cell(flat, open_flat, level == q[x - 1], fresh);
        open_steep[x] = next_cell(steep, open_steep[x], level == above[x], fresh);
        open_rising[x] = next_cell(rising, open_rising[x + 1], level == above[x + 1], fresh);
        const std::uint32_t keep = open_falling[x];
        open_falling[x] = next_cell(falling, up_left, level == above[x - 1], fresh);
        up_left = keep;
      }
      if (const int x = w - 1; x > 0) {
        const std::uint32_t fresh = fresh_cell(q[x]);
        open_flat = next_cell(flat, open_flat, q[x] == q[x - 1], fresh);
        open_steep[x] = next_cell(steep, open_steep[x], q[x] == above[x], fresh);
        open_rising[x] = fresh;
        open_falling[x] = next_cell(falling, up_left, q[x] == above[x - 1], fresh);
      }
    }
    ++flat[open_flat];
    if (y + 1 < h) {  // these leave the region sideways
      ++rising[open_rising[0]];
      ++falling[open_falling[w - 1]];
    }
  }
  for (int x = 0; x < w; ++x) {
    ++rising[open_rising[x]];
    ++steep[open_steep[x]];
    ++falling[open_falling[x]];
  }
}

}  // namespace heartservo::tracking
