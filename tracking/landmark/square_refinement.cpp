#include "tracking/landmark/square_refinement.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace heartservo::tracking {

namespace {

constexpr int kPointsPerSide = 40;
constexpr double kFromCorner = 0.12;   // of the side: nearer to a corner the other side's edge disturbs
constexpr double kProfileStep = 0.25;  // px
constexpr double kSmoothing = 1.0;     // px; large enough for the pixel grid not to matter, small against the rim
constexpr int kRadius = 5;             // px, of the smoothing
constexpr double kSmallestRise = 8;    // grey / px

using Eigen::Vector2d;

// Rise of the grey level per px along `outward` at p, smoothed by a Gaussian. The derivative is convolved straight from
// the pixels: interpolating first would pull an edge that runs along the pixel grid towards it.
double rise_at(const cv::Mat& grey, const Vector2d& p, const Vector2d& outward) {
  const int u0 = static_cast<int>(std::lround(p.x())), v0 = static_cast<int>(std::lround(p.y()));
  if (u0 < kRadius || v0 < kRadius || u0 + kRadius >= grey.cols || v0 + kRadius >= grey.rows) return NAN;
  double weight = 0, lever = 0, grey_sum = 0, rise = 0;
  for (int v = v0 - kRadius; v <= v0 + kRadius; ++v)
    for (int u = u0 - kRadius; u <= u0 + kRadius; ++u) {
      const Vector2d d(u - p.x(), v - p.y());
      const double w = std::exp(-d.squaredNorm() / (2 * kSmoothing * kSmoothing));
      const double g = static_cast<double>(grey.at<std::uint8_t>(v, u)), d_out = d.dot(outward);
      weight += w;
      lever += w * d_out;
      grey_sum += w * g;
      rise += w * d_out * g;
    }
  // the window is centred on a pixel, not on p: without the second term even a flat picture would rise
  return (rise - lever * grey_sum / weight) / (weight * kSmoothing * kSmoothing);
}

// Where the grey level rises fastest on the way outwards through `p`, in px from p; none if nowhere clearly.
std::optional<double> edge_offset(const cv::Mat& grey, const Vector2d& p, const Vector2d& outward, double search_px) {
  const int n = static_cast<int>(search_px / kProfileStep);
  int best = 0;
  double rise_before = NAN, rise_best = -1, rise_after = NAN, last = NAN;
  for (int i = -n; i <= n; ++i) {
    const double rise = rise_at(grey, p + outward * (i * kProfileStep), outward);
    if (i == best + 1) rise_after = rise;
    if (rise > rise_best) {
      best = i;
      rise_before = last;
      rise_best = rise;
      rise_after = NAN;
    }
    last = rise;
  }
  const double curvature = rise_before - 2 * rise_best + rise_after;
  if (!(rise_best > kSmallestRise) || !(curvature < 0)) return std::nullopt;
  return (best + 0.5 * (rise_before - rise_after) / curvature) * kProfileStep;
}

struct Line {
  Vector2d point, direction;
};

// Total least squares with Huber-like reweighting; `rms` in the points' unit.
Line fit_line(const std::vector<Vector2d>& points, double outlier, double& rms) {
  std::vector<double> weights(points.size(), 1);
  Line line{Vector2d::Zero(), Vector2d::UnitX()};
  for (int iteration = 0; iteration < 6; ++iteration) {
    double w = 0;
    Vector2d mean = Vector2d::Zero();
    for (std::size_t i = 0; i < points.size(); ++i) {
      w += weights[i];
      mean += weights[i] * points[i];
    }
    mean /= w;
    Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
    for (std::size_t i = 0; i < points.size(); ++i)
      scatter += weights[i] * (points[i] - mean) * (points[i] - mean).transpose();
    line = {mean, Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(scatter).eigenvectors().col(1)};
    double sum = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vector2d d = points[i] - mean;
      const double distance = d.x() * line.direction.y() - d.y() * line.direction.x();
      const double e = distance / outlier;
      weights[i] = 1 / (1 + e * e * e * e);
      sum += weights[i] * distance * distance;
    }
    rms = std::sqrt(sum / w);
  }
  return line;
}

Vector2d intersect(const Line& a, const Line& b) {
  Eigen::Matrix2d M;
  M << a.direction, -b.direction;
  const double determinant = M.determinant();
  if (std::abs(determinant) < 1e-6) return Vector2d::Constant(NAN);
  const Vector2d d = b.point - a.point;
  const double t = (d.x() * M(1, 1) - d.y() * M(0, 1)) / determinant;
  return a.point + t * a.direction;
}

// The square whose plane image is `quad`, scaled about its centre in its own plane.
Quad scaled(const Camera& camera, const Quad& quad, double ratio) {
  Quad plane;
  for (std::size_t i = 0; i < 4; ++i) plane[i] = camera.normalise(quad[i]);
  const Eigen::Matrix3d H = homography_between(rectangle(-1, -1, 2, 2), plane);
  Quad result = transform(H, rectangle(-ratio, -ratio, 2 * ratio, 2 * ratio));
  for (auto& corner : result) corner = camera.to_pixel(camera.distort(corner));
  return result;
}

}  // namespace

SquareRefinement refine_square(const cv::Mat& grey, const Camera& camera, const Quad& picked, double edge_ratio,
                               double search_px) {
  SquareRefinement result;
  result.corners = picked;
  if (!is_convex(picked) || grey.type() != CV_8UC1) return result;
  const Quad start = scaled(camera, picked, edge_ratio);
  Quad corners = start;
  if (!is_convex(start)) return result;
  for (int round = 0; round < 2; ++round) {  // the second starts close and so looks straight across the true side
    const double search = round == 0 ? search_px : std::min(search_px, 2.5);
    std::array<Line, 4> sides;
    double squares = 0;
    for (std::size_t side = 0; side < 4; ++side) {
      const Vector2d from = corners[side], to = corners[(side + 1) % 4];
      const Vector2d along = (to - from).normalized(), outward(along.y(), -along.x());
      std::vector<Vector2d> points;
      for (int i = 0; i < kPointsPerSide; ++i) {
        const double t = kFromCorner + (1 - 2 * kFromCorner) * i / (kPointsPerSide - 1);
        const Vector2d p = from + t * (to - from);
        if (const auto offset = edge_offset(grey, p, outward, search))
          points.push_back(camera.normalise(p + *offset * outward));
      }
      if (points.size() < kPointsPerSide / 2) return result;
      double rms = 0;
      sides[side] = fit_line(points, 0.3 / camera.fx, rms);
      squares += rms * rms * camera.fx * camera.fx / 4;
    }
    for (std::size_t i = 0; i < 4; ++i) {
      const Vector2d corner = camera.to_pixel(camera.distort(intersect(sides[(i + 3) % 4], sides[i])));
      if (!corner.allFinite() || (corner - start[i]).norm() > 2.5 * search_px) return result;
      corners[i] = corner;
    }
    result.edge_rms_px = std::sqrt(squares);
  }
  if (!is_convex(corners)) return result;
  result.refined = true;
  result.corners = scaled(camera, corners, 1 / edge_ratio);
  return result;
}

}  // namespace heartservo::tracking
