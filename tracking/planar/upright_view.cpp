#include "tracking/planar/upright_view.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "tracking/settings/target_clones.hpp"

namespace heartservo::tracking {

namespace {

constexpr int kLanes = UprightView::kPad;
constexpr double kSmallestShare = 0.3;     // of the template's points must be usable in the window
constexpr double kSmallestVariance = 0.3;  // grey^2; less is the rounding of a plain surface

using Lanes = float __attribute__((vector_size(kLanes * sizeof(float))));

struct WindowSums {
  float w, p, t, pp, tt, pt;
};

struct WindowRows {
  const float *grey, *clear;  // of the view, at the window's first point
  std::ptrdiff_t view_stride;
  const float *reference, *square, *usable;  // of the template
  std::ptrdiff_t stride, rows;
};

// Plain loops of whole vectors; the compiler keeps the six sums in registers only when told so.
HEARTSERVO_SIMD void add_up(const WindowRows& in, WindowSums& out) {
  Lanes w{}, p{}, t{}, pp{}, tt{}, pt{};
  const auto load = [](const float* from, Lanes& to) { std::memcpy(&to, from, sizeof(Lanes)); };
  for (std::ptrdiff_t row = 0; row < in.rows; ++row)
    for (std::ptrdiff_t i = 0; i < in.stride; i += kLanes) {
      const std::ptrdiff_t at = row * in.stride + i, seen = row * in.view_stride + i;
      Lanes grey, clear, reference, square, usable;
      load(in.grey + seen, grey);
      load(in.clear + seen, clear);
      load(in.reference + at, reference);
      load(in.square + at, square);
      load(in.usable + at, usable);
      const Lanes used = usable * grey;
      w += usable * clear;
      p += used;
      pp += used * grey;
      t += clear * reference;
      tt += clear * square;
      pt += grey * reference;
    }
  out = {};
  for (int k = 0; k < kLanes; ++k)
    out.w += w[k], out.p += p[k], out.t += t[k], out.pp += pp[k], out.tt += tt[k], out.pt += pt[k];
}

}  // namespace

void UprightView::shape(const Patch& patch, int margin) {
  grid.width = patch.width + 2 * margin;
  grid.height = patch.height + 2 * margin;
  grid.step = patch.step;
  if (grey.size() < size() + kPad) {
    grey.assign(size() + kPad, 0);
    clear.assign(size() + kPad, 0);
  }
}

WindowTemplate::WindowTemplate(const Patch& patch)
    : width(patch.width), height(patch.height), stride((patch.width + kLanes - 1) / kLanes * kLanes) {
  const auto n = static_cast<std::size_t>(stride) * static_cast<std::size_t>(height);
  grey.assign(n, 0);
  square.assign(n, 0);
  usable.assign(n, 0);
  double sum = 0;
  for (std::size_t i = 0; i < patch.size(); ++i) {
    points += static_cast<double>(patch.usable[i]);
    sum += static_cast<double>(patch.usable[i] * patch.grey[i]);
  }
  mean = points > 0 ? static_cast<float>(sum / points) : 0;
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column) {
      const auto from = static_cast<std::size_t>(row * width + column),
                 to = static_cast<std::size_t>(row * stride + column);
      usable[to] = patch.usable[from];
      grey[to] = patch.usable[from] * (patch.grey[from] - mean);
      square[to] = grey[to] * grey[to];
    }
}

void look(const SearchPicture& picture, int level, const Camera& camera, const Eigen::Matrix3d& G_plane_patch,
          Interpolation interpolation, float mean, UprightView& view) {
  const std::size_t n = view.size();
  warp(picture.pyramid().level(level), camera, G_plane_patch, view.grid, interpolation, view.grey.data(),
       view.clear.data());
  if (picture.has_glare()) {
    if (view.scratch.size() < 2 * n) view.scratch.resize(2 * n);
    float* glare = view.scratch.data();
    warp(picture.glare(level), camera, G_plane_patch, view.grid, Interpolation::LINEAR, glare, glare + n);
    for (std::size_t i = 0; i < n; ++i) view.clear[i] = glare[i] > 0 ? 0.0F : view.clear[i];
  }
  for (std::size_t i = 0; i < n; ++i) view.grey[i] = view.clear[i] * (view.grey[i] - mean);
  std::fill_n(view.grey.begin() + static_cast<std::ptrdiff_t>(n), UprightView::kPad, 0.0F);
  std::fill_n(view.clear.begin() + static_cast<std::ptrdiff_t>(n), UprightView::kPad, 0.0F);
}

WindowFit fit_of(const WindowTemplate& reference, const UprightView& view, int x, int y) {
  const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(y) * view.grid.width + x;
  WindowSums s;
  add_up({view.grey.data() + at, view.clear.data() + at, view.grid.width, reference.grey.data(),
          reference.square.data(), reference.usable.data(), reference.stride, reference.height},
         s);
  const double w = static_cast<double>(s.w), p = static_cast<double>(s.p), t = static_cast<double>(s.t);
  WindowFit fit;
  if (!(w >= kSmallestShare * reference.points) || !(w > 0)) return fit;
  const double p_variance = static_cast<double>(s.pp) / w - p / w * p / w;
  const double t_variance = static_cast<double>(s.tt) / w - t / w * t / w;
  if (!(p_variance > kSmallestVariance) || !(t_variance > kSmallestVariance)) {
    fit.d = 0.5;
    return fit;
  }
  const double covariance = static_cast<double>(s.pt) / w - p / w * t / w;
  fit.d = std::clamp(0.5 * (1 - covariance / std::sqrt(p_variance * t_variance)), 0.0, 1.0);
  const double mean = static_cast<double>(reference.mean);
  fit.light.gain = std::sqrt(t_variance / p_variance);
  fit.light.bias = mean + t / w - fit.light.gain * (mean + p / w);
  return fit;
}

}  // namespace heartservo::tracking
