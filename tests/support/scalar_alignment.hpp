#pragma once
// The alignment's inner loops written out plainly, point by point and in double: what the vector loops have to give.
#include <algorithm>
#include <cmath>
#include <vector>

#include "tracking/planar/normal_equations.hpp"
#include "tracking/planar/sl3.hpp"

namespace heartservo::test {

struct ScalarSample {
  bool inside = false;
  double grey = 0;
};

/// Catmull-Rom.
inline double cubic(double a, double p0, double p1, double p2, double p3) {
  return p1 + 0.5 * a * (p2 - p0 + a * (2 * p0 - 5 * p1 + 4 * p2 - p3 + a * (3 * (p1 - p2) + p3 - p0)));
}

inline ScalarSample scalar_sample(const tracking::PyramidLevel& level, const tracking::Camera& camera,
                                  const Eigen::Matrix3d& G, const Eigen::Vector2d& patch_point, bool is_cubic) {
  const Eigen::Vector2d plane = (G * patch_point.homogeneous()).hnormalized();
  const double x = plane.x(), y = plane.y(), r2 = x * x + y * y;
  const double radial = 1 + r2 * (camera.k1 + r2 * camera.k2);
  const double xd = x * radial + 2 * camera.k3 * x * y + camera.k4 * (r2 + 2 * x * x);
  const double yd = y * radial + camera.k3 * (r2 + 2 * y * y) + 2 * camera.k4 * x * y;
  const double scale = static_cast<double>(level.scale);
  const double u = (camera.fx * xd + camera.cx) * scale - static_cast<double>(level.u0);
  const double v = (camera.fy * yd + camera.cy) * scale - static_cast<double>(level.v0);
  const double border = is_cubic ? 1 : 0;
  const cv::Mat image = level.floats();
  const double uc = std::clamp(u, border, image.cols - 1.001 - border);
  const double vc = std::clamp(v, border, image.rows - 1.001 - border);
  const int iu = static_cast<int>(uc), iv = static_cast<int>(vc);
  const double a = uc - iu, b = vc - iv;
  const auto pixel = [&](int du, int dv) { return static_cast<double>(image.at<float>(iv + dv, iu + du)); };
  ScalarSample s;
  s.inside = uc == u && vc == v;
  if (is_cubic) {
    double row[4];
    for (int k = -1; k <= 2; ++k) row[k + 1] = cubic(a, pixel(-1, k), pixel(0, k), pixel(1, k), pixel(2, k));
    s.grey = cubic(b, row[0], row[1], row[2], row[3]);
  } else {
    s.grey = (1 - b) * ((1 - a) * pixel(0, 0) + a * pixel(1, 0)) + b * ((1 - a) * pixel(0, 1) + a * pixel(1, 1));
  }
  return s;
}

struct ScalarPass {
  Eigen::Matrix<double, 10, 10> JtJ = Eigen::Matrix<double, 10, 10>::Zero();
  Eigen::Matrix<double, 10, 1> Jtr = Eigen::Matrix<double, 10, 1>::Zero();
  double points = 0, weight = 0;
  std::vector<double> residual, weights;  ///< 0 at the border
};

/// `scale`: the residual without weight.
inline ScalarPass scalar_pass(const tracking::Patch& patch, const tracking::Light& light, const std::vector<float>& grey,
                              double scale) {
  ScalarPass pass;
  pass.residual.assign(patch.size(), 0);
  pass.weights.assign(patch.size(), 0);
  const auto g = [&](std::size_t i) { return static_cast<double>(grey[i]); };
  const auto w = static_cast<std::size_t>(patch.width);
  const double share = static_cast<double>(patch.template_share), step = static_cast<double>(patch.step);
  for (int row = 1; row + 1 < patch.height; ++row)
    for (int column = 1; column + 1 < patch.width; ++column) {
      const auto i = static_cast<std::size_t>(row) * w + static_cast<std::size_t>(column);
      const double gain = light.gain + (light.gain_offset ? static_cast<double>(light.gain_offset[i]) : 0.0);
      const double r = gain * g(i) + light.bias - static_cast<double>(patch.grey[i]);
      if (!(patch.usable[i] > 0)) continue;
      pass.residual[i] = r;
      bool clear = true;
      for (const std::size_t k : {i, i - 1, i + 1, i - w, i + w}) clear &= grey[k] < tracking::kSaturatedGrey;
      if (!clear) continue;
      ++pass.points;
      const double bell = std::max(0.0, 1 - r * r / (scale * scale)), weight = bell * bell;
      pass.weight += pass.weights[i] = weight;
      const double half = (1 - share) * 0.5 * light.gain / step;
      const Eigen::RowVector2d gradient(share * static_cast<double>(patch.gradient_x[i]) + half * (g(i + 1) - g(i - 1)),
                                        share * static_cast<double>(patch.gradient_y[i]) + half * (g(i + w) - g(i - w)));
      Eigen::Matrix<double, 10, 1> J;
      J << (gradient * tracking::sl3_point_jacobian(static_cast<double>(patch.x_of(column)),
                                                    static_cast<double>(patch.y_of(row))))
               .transpose(),
          g(i), 1;
      pass.JtJ += weight * J * J.transpose();
      pass.Jtr += weight * r * J;
    }
  return pass;
}

}  // namespace heartservo::test
