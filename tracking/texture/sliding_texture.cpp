#include "tracking/texture/sliding_texture.hpp"

#include <algorithm>
#include <cstdlib>

namespace heartservo::tracking {

namespace {

constexpr int kWorthwhileSteps = 12;  // beyond, building afresh is as quick

// A side of the window, as a line of `length` pixels `step` apart; the window lies `inwards`, `depth` pixels deep, the
// line included. Directions of runs as seen from the line.
struct Edge {
  const std::uint8_t* level;
  const RunReach* run;
  std::ptrdiff_t step, inwards;
  int length, depth;
};

struct EdgeDirections {
  RunDirection across, forward, backward, along;  // inwards; inwards and on along the line; inwards and back; along it
};

template <EdgeDirections kLook>
void update_runs(const Edge& e, std::uint32_t sign, RunLengthMatrix& runs, LevelHistogram& histogram) {
  std::uint32_t* counts = runs.counts.data();
  const auto stride = static_cast<std::uint32_t>(runs.stride);
  const auto change = [sign](std::uint32_t* row, int n) {  // a run of n, which was n - 1 without the line's pixel
    row[n] += sign;
    row[n - 1] -= sign;
  };
  for (int k = 0; k < e.length; ++k) {
    const std::uint8_t level = e.level[k * e.step];
    const RunReach& run = e.run[k * e.step];
    std::uint32_t* row = counts + level * stride;
    histogram.counts[level] += sign;
    change(row, std::min<int>(run.reach[kLook.across], e.depth));
    change(row, std::min({static_cast<int>(run.reach[kLook.forward]), e.depth, e.length - k}));
    change(row, std::min({static_cast<int>(run.reach[kLook.backward]), e.depth, k + 1}));
  }
  for (int k = 0; k < e.length;) {
    const int n = std::min<int>(e.run[k * e.step].reach[kLook.along], e.length - k);
    counts[e.level[k * e.step] * stride + static_cast<std::uint32_t>(n)] += sign;
    k += n;
  }
}

void update_pairs(const Edge& e, int d, std::uint32_t sign, CooccurrenceMatrix& pairs) {
  std::uint32_t* counts = pairs.counts.data();
  const auto stride = static_cast<std::uint32_t>(pairs.stride);
  const auto change = [=](std::uint8_t a, std::uint8_t b) {
    counts[a * stride + b] += sign;
    counts[b * stride + a] += sign;
  };
  for (int k = 0; k + d < e.length; ++k) change(e.level[k * e.step], e.level[(k + d) * e.step]);
  if (d >= e.depth) return;
  const std::uint8_t* inner = e.level + d * e.inwards;
  for (int k = 0; k < e.length; ++k) change(e.level[k * e.step], inner[k * e.step]);
  for (int k = 0; k + d < e.length; ++k) {
    change(e.level[k * e.step], inner[(k + d) * e.step]);
    change(e.level[(k + d) * e.step], inner[k * e.step]);
  }
}

}  // namespace

SlidingTexture::SlidingTexture(const TextureSettings& settings, int width, int height)
    : settings_(settings), width_(width), height_(height) {}

void SlidingTexture::load(const GreyRegion& grey, const GreyRegion* usable) {
  quantise(grey, settings_, picture_, usable);
  prepare();
}

void SlidingTexture::load(const LevelRegion& picture) {
  picture_.width = picture.width;
  picture_.height = picture.height;
  picture_.levels = picture.levels;
  picture_.data.resize(static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height));
  for (int y = 0; y < picture.height; ++y)
    std::copy_n(picture.row(y), picture.width, picture_.data.begin() + static_cast<std::ptrdiff_t>(y) * picture.width);
  prepare();
}

void SlidingTexture::prepare() { runs_.build(picture_.region()); }

void SlidingTexture::place(int x, int y) {
  x_ = x;
  y_ = y;
  builder_.build(picture_.region(x, y, width_, height_), settings_.distance, matrices_);
}

bool SlidingTexture::move(int dx, int dy) {
  const int x = x_ + dx, y = y_ + dy;
  if (x < 0 || y < 0 || x + width_ > picture_.width || y + height_ > picture_.height) return false;
  if (std::abs(dx) + std::abs(dy) > kWorthwhileSteps) {
    place(x, y);
    return true;
  }
  while (x_ != x) {
    const bool right = x > x_;
    update(right ? Side::LEFT : Side::RIGHT, -1);
    x_ += right ? 1 : -1;
    update(right ? Side::RIGHT : Side::LEFT, 1);
  }
  while (y_ != y) {
    const bool down = y > y_;
    update(down ? Side::TOP : Side::BOTTOM, -1);
    y_ += down ? 1 : -1;
    update(down ? Side::BOTTOM : Side::TOP, 1);
  }
  return true;
}

void SlidingTexture::update(Side side, int sign_of_change) {
  const auto sign = static_cast<std::uint32_t>(sign_of_change);  // counts wrap: adding it subtracts one
  const bool column = side == Side::LEFT || side == Side::RIGHT;
  const int x = side == Side::RIGHT ? x_ + width_ - 1 : x_, y = side == Side::BOTTOM ? y_ + height_ - 1 : y_;
  const std::ptrdiff_t row = picture_.width;
  Edge edge{picture_.region().row(y) + x, runs_.row(y) + x,         column ? row : 1, column ? 1 : row,
            column ? height_ : width_,    column ? width_ : height_};
  if (side == Side::RIGHT || side == Side::BOTTOM) edge.inwards = -edge.inwards;
  auto& runs = matrices_.runs;
  auto& histogram = matrices_.histogram;
  switch (side) {
    case Side::LEFT:
      update_runs<EdgeDirections{RIGHT, DOWN_RIGHT, UP_RIGHT, DOWN}>(edge, sign, runs, histogram);
      break;
    case Side::RIGHT:
      update_runs<EdgeDirections{LEFT, DOWN_LEFT, UP_LEFT, DOWN}>(edge, sign, runs, histogram);
      break;
    case Side::TOP:
      update_runs<EdgeDirections{DOWN, DOWN_RIGHT, DOWN_LEFT, RIGHT}>(edge, sign, runs, histogram);
      break;
    case Side::BOTTOM:
      update_runs<EdgeDirections{UP, UP_RIGHT, UP_LEFT, RIGHT}>(edge, sign, runs, histogram);
      break;
  }
  update_pairs(edge, settings_.distance, sign, matrices_.pairs);
}

}  // namespace heartservo::tracking
