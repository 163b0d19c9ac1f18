#include "tracking/planar/correlation_aligner.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "tracking/planar/quad.hpp"
#include "tracking/planar/template_judge.hpp"

namespace heartservo::tracking {

namespace {

// Where the parabola through three values at -1, 0, 1 has its top; 0 when the middle one is no peak.
double parabola_top(float before, float peak, float after) {
  const double curvature = static_cast<double>(before) - 2 * static_cast<double>(peak) + static_cast<double>(after);
  if (!(curvature < 0) || before > peak || after > peak) return 0;
  return 0.5 * static_cast<double>(before - after) / curvature;
}

class CorrelationAligner final : public PatchAligner {
 public:
  explicit CorrelationAligner(const CorrelationOptions& options) : options_(options) {}

  void learn(const ImagePyramid& picture, const Camera& camera, const Eigen::Matrix3d& G, int side_x,
             int side_y) override {
    judge_.learn(picture, camera, G, side_x, side_y);
    G_reference_ = G;
    reference_centre_ = centre_px(G);
    const double larger = std::max(side_x, side_y);
    Eigen::Array2d low(1e9, 1e9), high(-1e9, -1e9);
    for (const auto& c :
         transform(G, rectangle(-side_x / larger, -side_y / larger, 2 * side_x / larger, 2 * side_y / larger))) {
      const Eigen::Vector2d pixel = camera.to_pixel(camera.distort(c));
      low = low.min(pixel.array());
      high = high.max(pixel.array());
    }
    const PyramidLevel& level = picture.level(0);
    const cv::Point origin(static_cast<int>(level.u0), static_cast<int>(level.v0));
    const cv::Rect box(
        cv::Point(static_cast<int>(std::ceil(low.x())), static_cast<int>(std::ceil(low.y()))) - origin,
        cv::Point(static_cast<int>(std::floor(high.x())) + 1, static_cast<int>(std::floor(high.y())) + 1) - origin);
    const cv::Rect clipped = box & cv::Rect(0, 0, level.bytes.cols, level.bytes.rows);
    template_ = level.bytes(clipped).clone();
    corner_ = clipped.tl() + origin;
  }

  const Patch& patch(int level) const override { return judge_.patch(level); }
  bool obeys_model() const override { return false; }

  Alignment align(const ImagePyramid& picture, const Alignment& start, int /*coarsest*/, MotionModel) override {
    Alignment a = start;
    a.converged = false;
    a.iterations = 1;
    const Eigen::Vector2d shift = centre_px(start.G_plane_patch) - reference_centre_;
    if (template_.empty() || !shift.allFinite() || shift.cwiseAbs().maxCoeff() > 1e5) return a;
    const PyramidLevel& level = picture.level(0);
    const int radius = static_cast<int>(std::ceil(options_.search_px));
    const cv::Point origin(static_cast<int>(level.u0), static_cast<int>(level.v0));
    const cv::Point expected(corner_.x + static_cast<int>(std::lround(shift.x())),
                             corner_.y + static_cast<int>(std::lround(shift.y())));
    const cv::Rect wanted(expected - origin - cv::Point(radius, radius),
                          cv::Size(template_.cols + 2 * radius, template_.rows + 2 * radius));
    const cv::Rect window = wanted & cv::Rect(0, 0, level.bytes.cols, level.bytes.rows);
    if (window.width < template_.cols || window.height < template_.rows) return a;
    cv::matchTemplate(level.bytes(window), template_, score_, cv::TM_CCOEFF_NORMED);
    cv::patchNaNs(score_, -1);
    cv::Point peak;
    cv::minMaxLoc(score_, nullptr, nullptr, nullptr, &peak);
    const cv::Point found = window.tl() + origin + peak - corner_;
    move_to(reference_centre_ + Eigen::Vector2d(found.x, found.y) + between_pixels(peak), a);
    judge_.judge(picture, a);
    return a;
  }

 private:
  Eigen::Vector2d centre_px(const Eigen::Matrix3d& G) const {
    const Camera& camera = judge_.camera();
    return camera.to_pixel(camera.distort((G * Eigen::Vector3d::UnitZ()).hnormalized()));
  }

  Eigen::Vector2d between_pixels(const cv::Point& p) const {
    Eigen::Vector2d offset = Eigen::Vector2d::Zero();
    const auto at = [&](int x, int y) { return score_.at<float>(p.y + y, p.x + x); };
    if (p.x > 0 && p.x + 1 < score_.cols) offset.x() = parabola_top(at(-1, 0), at(0, 0), at(1, 0));
    if (p.y > 0 && p.y + 1 < score_.rows) offset.y() = parabola_top(at(0, -1), at(0, 0), at(0, 1));
    return offset;
  }

  // The reference, moved on the plane so that its centre shows at the given pixel.
  void move_to(const Eigen::Vector2d& pixel, Alignment& a) const {
    Eigen::Matrix3d move = Eigen::Matrix3d::Identity();
    move.topRightCorner<2, 1>() = judge_.camera().normalise(pixel) - judge_.camera().normalise(reference_centre_);
    a.G_plane_patch = move * G_reference_;
  }

  CorrelationOptions options_;
  TemplateJudge judge_;
  Eigen::Matrix3d G_reference_ = Eigen::Matrix3d::Identity();
  Eigen::Vector2d reference_centre_ = Eigen::Vector2d::Zero();  // px
  cv::Mat template_, score_;                                    // CV_32FC1
  cv::Point corner_;                                            // the template's first pixel in the reference picture
};

}  // namespace

std::unique_ptr<PatchAligner> make_correlation_aligner(const CorrelationOptions& options) {
  return std::make_unique<CorrelationAligner>(options);
}

}  // namespace heartservo::tracking
