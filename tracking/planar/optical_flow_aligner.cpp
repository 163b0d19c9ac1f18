#include "tracking/planar/optical_flow_aligner.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "tracking/planar/quad.hpp"
#include "tracking/planar/sl3.hpp"
#include "tracking/planar/template_judge.hpp"

namespace heartservo::tracking {

namespace {

constexpr std::size_t kFewestPoints = 8;
constexpr int kRansacRounds = 500;
constexpr double kRansacConfidence = 0.995;

// A picture with the region in it: what a chain of homographies goes on from.
struct Anchor {
  cv::Mat grey;
  Eigen::Matrix3d G_plane_patch = Eigen::Matrix3d::Identity();
  std::vector<cv::Point2f> points;  // px
};

class OpticalFlowAligner final : public PatchAligner {
 public:
  explicit OpticalFlowAligner(const OpticalFlowOptions& options) : options_(options) {}

  void learn(const ImagePyramid& picture, const Camera& camera, const Eigen::Matrix3d& G, int side_x,
             int side_y) override {
    judge_.learn(picture, camera, G, side_x, side_y);
    const double larger = std::max(side_x, side_y);
    patch_corners_ = rectangle(-side_x / larger, -side_y / larger, 2 * side_x / larger, 2 * side_y / larger);
    levels_ = picture.levels();
    set(reference_, G);
    chained_ = false;
  }

  const Patch& patch(int level) const override { return judge_.patch(level); }
  bool obeys_model() const override { return false; }
  void see(const cv::Mat& grey) override { seen_ = grey; }
  void forget() override { chained_ = false; }

  void believe(const Alignment& alignment) override {
    set(previous_, alignment.G_plane_patch);
    chained_ = true;
  }

  Alignment align(const ImagePyramid& picture, const Alignment& start, int /*coarsest*/, MotionModel) override {
    Alignment a = start;
    a.converged = false;
    a.iterations = 1;
    if (!start.G_plane_patch.allFinite()) return a;
    if (flow(chained_ ? previous_ : reference_, a)) judge_.judge(picture, a);
    return a;
  }

 private:
  // Makes the picture last seen an anchor, with the region at G and new corners to follow.
  void set(Anchor& anchor, const Eigen::Matrix3d& G) {
    seen_.copyTo(anchor.grey);  // the source may overwrite its memory
    anchor.G_plane_patch = G;
    anchor.points.clear();
    const cv::Rect box = box_of(G, 1) & cv::Rect(0, 0, seen_.cols, seen_.rows);
    if (box.width < 8 || box.height < 8) return;
    std::vector<cv::Point> outline;
    for (const auto& c : corners_px(G))
      outline.emplace_back(static_cast<int>(std::lround(c.x())) - box.x, static_cast<int>(std::lround(c.y())) - box.y);
    mask_.create(box.size(), CV_8UC1);
    mask_.setTo(0);
    cv::fillConvexPoly(mask_, outline, cv::Scalar(255));
    const double side = std::sqrt(static_cast<double>(box.area()));
    cv::goodFeaturesToTrack(anchor.grey(box), anchor.points, options_.max_points, 0.01, std::max(2.0, side / 16),
                            mask_);
    for (auto& p : anchor.points) p += cv::Point2f(box.tl());
  }

  // From the anchor to the picture last seen; a.G_plane_patch says where about the region is now.
  bool flow(const Anchor& anchor, Alignment& a) {
    if (anchor.points.size() < kFewestPoints || seen_.size() != anchor.grey.size()) return false;
    const Eigen::Matrix3d expected = a.G_plane_patch * anchor.G_plane_patch.inverse();
    const int margin = options_.window_px + (1 << levels_);
    const cv::Rect window = (box_of(anchor.G_plane_patch, margin) | box_of(a.G_plane_patch, margin)) &
                            cv::Rect(0, 0, seen_.cols, seen_.rows);
    if (window.width < 2 * options_.window_px || window.height < 2 * options_.window_px) return false;
    const cv::Point2f origin(window.tl());
    from_.clear();
    to_.clear();
    for (const auto& p : anchor.points) {
      const Eigen::Vector2d q = pixel_of((expected * plane_of(p).homogeneous()).hnormalized());
      if (!q.allFinite()) return false;
      from_.push_back(p - origin);
      to_.push_back(cv::Point2f(static_cast<float>(q.x()), static_cast<float>(q.y())) - origin);
    }
    back_ = from_;
    const cv::Size size(options_.window_px, options_.window_px);
    const cv::TermCriteria stop(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 30, 0.005);
    constexpr int kGuess = cv::OPTFLOW_USE_INITIAL_FLOW;
    // Not "reuse the input": OpenCV 4.6 then copies a window's border onto itself, overlapping.
    const auto pyramid = [&](const cv::Mat& picture, std::vector<cv::Mat>& levels) {
      cv::buildOpticalFlowPyramid(picture(window), levels, size, levels_ - 1, true, cv::BORDER_REFLECT_101,
                                  cv::BORDER_CONSTANT, false);
    };
    pyramid(anchor.grey, before_);
    pyramid(seen_, after_);
    cv::calcOpticalFlowPyrLK(before_, after_, from_, to_, found_, error_, size, levels_ - 1, stop, kGuess);
    cv::calcOpticalFlowPyrLK(after_, before_, to_, back_, returned_, error_, size, levels_ - 1, stop, kGuess);
    return chain(anchor, origin, a);
  }

  // RANSAC on the undistorted plane, in px of it.
  bool chain(const Anchor& anchor, const cv::Point2f& origin, Alignment& a) {
    const double focal = judge_.camera().fx;
    std::vector<cv::Point2d>&source = plane_from_, &target = plane_to_;
    source.clear();
    target.clear();
    for (std::size_t i = 0; i < from_.size(); ++i) {
      if (!found_[i] || !returned_[i] || !(cv::norm(back_[i] - from_[i]) < options_.return_px)) continue;
      const Eigen::Vector2d p = plane_of(from_[i] + origin) * focal, q = plane_of(to_[i] + origin) * focal;
      if (!p.allFinite() || !q.allFinite()) continue;
      source.emplace_back(p.x(), p.y());
      target.emplace_back(q.x(), q.y());
    }
    if (source.size() < kFewestPoints) return false;
    const cv::Mat found =
        cv::findHomography(source, target, cv::RANSAC, options_.inlier_px, inliers_, kRansacRounds, kRansacConfidence);
    if (found.empty() || cv::countNonZero(inliers_) < static_cast<int>(kFewestPoints)) return false;
    Eigen::Matrix3d H;
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column) H(row, column) = found.at<double>(row, column);
    const Eigen::Vector3d to_px(focal, focal, 1);
    H = to_px.cwiseInverse().asDiagonal() * H * to_px.asDiagonal();
    a.G_plane_patch = to_sl3(H * anchor.G_plane_patch);
    return a.G_plane_patch.allFinite();
  }

  Eigen::Vector2d plane_of(const cv::Point2f& p) const {
    return judge_.camera().normalise(Eigen::Vector2d(static_cast<double>(p.x), static_cast<double>(p.y)));
  }
  Eigen::Vector2d pixel_of(const Eigen::Vector2d& plane) const {
    return judge_.camera().to_pixel(judge_.camera().distort(plane));
  }
  Quad corners_px(const Eigen::Matrix3d& G) const {
    Quad corners = transform(G, patch_corners_);
    for (auto& c : corners) c = pixel_of(c);
    return corners;
  }
  cv::Rect box_of(const Eigen::Matrix3d& G, int margin) const {
    Eigen::Array2d low(1e5, 1e5), high(-1e5, -1e5);
    for (const auto& c : corners_px(G)) {
      if (!c.allFinite()) return {};
      low = low.min(c.array().max(-1e5));
      high = high.max(c.array().min(1e5));
    }
    const cv::Point from(static_cast<int>(low.x()) - margin, static_cast<int>(low.y()) - margin);
    const cv::Point to(static_cast<int>(high.x()) + margin + 2, static_cast<int>(high.y()) + margin + 2);
    return {from, to};
  }

  OpticalFlowOptions options_;
  TemplateJudge judge_;
  Quad patch_corners_{};
  int levels_ = 1;
  bool chained_ = false;         // go on from previous_, else from reference_
  Anchor reference_, previous_;  // where the region was learnt, and where it was last believed
  cv::Mat seen_, mask_, inliers_;
  std::vector<cv::Mat> before_, after_;
  std::vector<cv::Point2f> from_, to_, back_;
  std::vector<cv::Point2d> plane_from_, plane_to_;
  std::vector<unsigned char> found_, returned_;
  std::vector<float> error_;
};

}  // namespace

std::unique_ptr<PatchAligner> make_optical_flow_aligner(const OpticalFlowOptions& options) {
  return std::make_unique<OpticalFlowAligner>(options);
}

}  // namespace heartservo::tracking
