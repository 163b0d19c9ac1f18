#include "tracking/planar/visp_aligner.hpp"

#include <gsl/gsl_errno.h>
#include <visp3/tt/vpTemplateTrackerSSDESM.h>
#include <visp3/tt/vpTemplateTrackerSSDInverseCompositional.h>
#include <visp3/tt/vpTemplateTrackerWarpHomographySL3.h>
#include <visp3/tt/vpTemplateTrackerZNCCInverseCompositional.h>
#include <visp3/tt_mi/vpTemplateTrackerMIInverseCompositional.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <unsupported/Eigen/MatrixFunctions>

#include "tracking/planar/quad.hpp"
#include "tracking/planar/sl3.hpp"
#include "tracking/planar/template_judge.hpp"
#include "tracking/settings/quiet_streams.hpp"

namespace heartservo::tracking {

namespace {

constexpr double kWorthTrying = 0.1;  // correlation of template and picture at the start
constexpr unsigned int kMaxIterations = 200;
constexpr double kCostThreshold = 1e-7;

// ViSP inverts its matrices through the GNU Scientific Library, whose own handler ends the process at a singular one
// (a plain region). Without a handler the inverse is not finite, which is noticed here. Off for good: to switch it per
// call would not be safe with threads.
void survive_singular_matrices() { [[maybe_unused]] static const auto before = gsl_set_error_handler_off(); }

std::unique_ptr<vpTemplateTracker> make_visp_tracker(VispMethod method, vpTemplateTrackerWarp* warp) {
  std::unique_ptr<vpTemplateTracker> tracker;
  switch (method) {
    case VispMethod::ESM:
      tracker = std::make_unique<vpTemplateTrackerSSDESM>(warp);
      break;
    case VispMethod::IC:
      tracker = std::make_unique<vpTemplateTrackerSSDInverseCompositional>(warp);
      break;
    case VispMethod::ZNCC:
      tracker = std::make_unique<vpTemplateTrackerZNCCInverseCompositional>(warp);
      break;
    case VispMethod::MI: {
      auto mi = std::make_unique<vpTemplateTrackerMIInverseCompositional>(warp);
      mi->setMinimizationMethod(vpTemplateTrackerMIInverseCompositional::USE_NEWTON);
      tracker = std::move(mi);
      break;
    }
  }
  tracker->setSampling(1, 1);
  tracker->setIterationMax(kMaxIterations);
  if (method == VispMethod::ESM || method == VispMethod::IC) {
    tracker->setLambda(0);
    tracker->setThresholdResidualDifference(kCostThreshold);
  }
  return tracker;
}

// The coordinates of H in ViSP's basis of sl(3): log H is p[0..3] at (0,2), (1,2), (0,1), (1,0), then
// diag(p4, -p4 - p5, p5), then p[6..7] in the last row (vpTemplateTrackerWarpHomographySL3.cpp).
bool parameters_of(const Eigen::Matrix3d& H, vpColVector& p) {
  const Eigen::Matrix3d A = H.log();
  if (!A.allFinite()) return false;
  p.resize(8);
  p[0] = A(0, 2), p[1] = A(1, 2), p[2] = A(0, 1), p[3] = A(1, 0);
  p[4] = A(0, 0), p[5] = A(2, 2);
  p[6] = A(2, 0), p[7] = A(2, 1);
  return true;
}

class VispAligner final : public PatchAligner {
 public:
  explicit VispAligner(VispMethod method) : method_(method) { survive_singular_matrices(); }

  void learn(const ImagePyramid& picture, const Camera& camera, const Eigen::Matrix3d& G, int side_x,
             int side_y) override {
    judge_.learn(picture, camera, G, side_x, side_y);
    G_reference_ = G;
    const QuietStreams quiet;
    tracker_.reset();
    try {
      const double larger = std::max(side_x, side_y);
      std::vector<vpImagePoint> corners;
      for (const auto& c :
           transform(G, rectangle(-side_x / larger, -side_y / larger, 2 * side_x / larger, 2 * side_y / larger))) {
        const Eigen::Vector2d pixel = camera.to_pixel(camera.distort(c));
        corners.emplace_back(pixel.y(), pixel.x());
      }
      auto tracker = make_visp_tracker(method_, &warp_);
      // two triangles
      tracker->initFromPoints(whole_picture(),
                              {corners[0], corners[1], corners[2], corners[0], corners[2], corners[3]});
      tracker_ = std::move(tracker);
    } catch (...) {  // plain regions: singular; the shell refuses them by their texture
    }
  }

  const Patch& patch(int level) const override { return judge_.patch(level); }
  bool obeys_model() const override { return false; }

  void see(const cv::Mat& grey) override {
    grey_ = grey;
    converted_ = false;
  }

  Alignment align(const ImagePyramid& picture, const Alignment& start, int /*coarsest*/, MotionModel) override {
    Alignment a = start;
    a.converged = false;
    a.iterations = 0;
    if (!tracker_ || !(judge_.correlation_at(picture, start.G_plane_patch) > kWorthTrying)) return a;
    if (run(a)) judge_.judge(picture, a);
    return a;
  }

 private:
  bool run(Alignment& a) {
    const QuietStreams quiet;
    try {
      vpColVector p;
      if (!parameters_of(to_sl3(a.G_plane_patch * G_reference_.inverse()), p)) return false;
      tracker_->setp(p);
      tracker_->track(whole_picture());
      a.iterations = static_cast<int>(tracker_->getNbIteration());
      if (tracker_->getDiverge()) return false;
      warp_.computeCoeff(tracker_->getp());
      const vpHomography found = warp_.getHomography();
      Eigen::Matrix3d H;
      for (unsigned int row = 0; row < 3; ++row)
        for (unsigned int column = 0; column < 3; ++column) H(row, column) = found[row][column];
      a.G_plane_patch = to_sl3(H * G_reference_);
      return a.G_plane_patch.allFinite();
    } catch (...) {  // out of the picture, singular: not converged
      return false;
    }
  }

  const vpImage<unsigned char>& whole_picture() {
    if (!converted_) {
      const auto width = static_cast<unsigned int>(grey_.cols), height = static_cast<unsigned int>(grey_.rows);
      if (image_.getWidth() != width || image_.getHeight() != height) image_.resize(height, width);
      for (unsigned int row = 0; row < height; ++row) std::memcpy(image_[row], grey_.ptr(static_cast<int>(row)), width);
      converted_ = true;
    }
    return image_;
  }

  VispMethod method_;
  TemplateJudge judge_;
  Eigen::Matrix3d G_reference_ = Eigen::Matrix3d::Identity();
  cv::Mat grey_;
  vpImage<unsigned char> image_;
  bool converted_ = false;
  vpTemplateTrackerWarpHomographySL3 warp_;  // outlives tracker_, which points to it
  std::unique_ptr<vpTemplateTracker> tracker_;
};

}  // namespace

std::unique_ptr<PatchAligner> make_visp_aligner(VispMethod method) { return std::make_unique<VispAligner>(method); }

}  // namespace heartservo::tracking
