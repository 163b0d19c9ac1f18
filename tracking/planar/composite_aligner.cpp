#include "tracking/planar/composite_aligner.hpp"

#include <algorithm>
#include <cmath>

#include "tracking/planar/candidate_search.hpp"
#include "tracking/planar/normal_equations.hpp"

namespace heartservo::tracking {

namespace {

constexpr double kForeseen_px = 4;       // how far to search when the last frames were foreseen to a pixel
constexpr double kConvincing = 0.9;      // an alignment as good as this ends the trial of candidates
constexpr double kHopeless = 0.35;       // d of a candidate not worth aligning from
constexpr double kClearlyBetter = 0.02;  // correlation that a place further away has to be ahead
constexpr double kSomeHidden = 0.02;
constexpr double kFewHidden = 0.6;   // of the template's points; with more the place itself is doubtful
constexpr double kOtherLight = 0.1;  // change of gain that the minimisation should not have to find

class CompositeAligner final : public PatchAligner {
 public:
  CompositeAligner(const CompositeOptions& options, const EsmOptions& esm)
      : options_(options), search_(options), esm_(make_esm_aligner(esm)) {}

  void see(const cv::Mat& grey) override {
    grey_ = grey;
    searched_ = false;
  }

  void learn(const ImagePyramid& picture, const Camera& camera, const Eigen::Matrix3d& G, int side_x,
             int side_y) override {
    camera_ = camera;
    side_px_ = std::max(side_x, side_y);
    hidden_.clear();
    searched_ = lost_ = false;
    esm_->learn(picture, camera, G, side_x, side_y);
    build(G, 0);
    search_.learn(picture_, camera, G, side_x, side_y);
  }

  const Patch& patch(int level) const override { return esm_->patch(level); }

  Alignment align(const ImagePyramid& /*picture*/, const Alignment& start, int coarsest, MotionModel model) override {
    if (!search_from(start, coarsest)) {
      Alignment a = start;
      a.converged = false;
      return a;
    }
    // The prediction is the nearest place: another one has to fit clearly better, or repeating texture would win.
    const Candidate& first = candidates_->front();
    Trial best = trial(with_light(start, first.light), coarsest, model);
    for (const Candidate& candidate : *candidates_) {
      const bool doubt = best.worth < kConvincing || (&candidate == &first && !first.at_start);
      if (!doubt) break;
      if (candidate.at_start || candidate.roi.d > kHopeless) continue;
      Alignment there = start;
      there.G_plane_patch = candidate.G_plane_patch;
      there.gain = candidate.light.gain;
      there.bias = candidate.light.bias;
      const Trial t = trial(there, search_.texture_level() + 1, model);
      if (t.worth > best.worth + kClearlyBetter) best = t;
    }
    return best.alignment;
  }

  void believe(const Alignment& a) override {
    look_for_hidden(a);
    lost_ = false;
  }
  void forget() override {
    hidden_.clear();
    searched_ = false;
    lost_ = true;
  }

 private:
  struct Trial {
    Alignment alignment;
    double worth = 0;
  };

  Trial trial(const Alignment& from, int coarsest, MotionModel model) {
    const Alignment a = esm_->align(picture_.pyramid(), from, coarsest, model);
    return {a, a.converged ? a.fit() : 0};
  }

  static Alignment with_light(Alignment a, const Light& light) {
    if (std::abs(std::log(light.gain / a.gain)) > kOtherLight) a.gain = light.gain, a.bias = light.bias;
    return a;
  }

  // Asked for the same start again, with another model, the candidates are the same.
  bool search_from(const Alignment& start, int coarsest) {
    if (!start.G_plane_patch.allFinite()) return false;
    if (searched_ && coarsest == searched_level_ && start.G_plane_patch == searched_from_) return !candidates_->empty();
    // once lost, the starts are what a search of the whole picture has found
    const double radius =
        coarsest <= 0 || lost_ ? kForeseen_px : std::min(options_.search_px, coarsest == 1 ? 10.0 : 1e9);
    build(start.G_plane_patch, radius);
    candidates_ = &search_.around(picture_, start.G_plane_patch, radius, hidden_);
    searched_ = true;
    searched_level_ = coarsest;
    searched_from_ = start.G_plane_patch;
    return !candidates_->empty();
  }

  // The part of the picture that candidates up to `radius` px from the place can reach.
  void build(const Eigen::Matrix3d& G, double radius_px) {
    const auto pixel = [&](double x, double y) {
      return camera_.to_pixel(camera_.distort((G * Eigen::Vector3d(x, y, 1)).hnormalized()));
    };
    const Eigen::Vector2d c = pixel(0, 0);
    double half = 0;
    for (const double x : {-1.0, 1.0})
      for (const double y : {-1.0, 1.0}) half = std::max(half, (pixel(x, y) - c).cwiseAbs().maxCoeff());
    half += 1.2 * radius_px + 20;
    const auto clip = [](double v) { return static_cast<int>(std::clamp(v, -1e6, 1e6)); };
    const cv::Rect window(cv::Point(clip(c.x() - half), clip(c.y() - half)),
                          cv::Point(clip(c.x() + half), clip(c.y() + half)));
    picture_.build(grey_, window, CandidateSearch::kLevels);
  }

  // Points that the robust weights of the believed alignment leave out, at the texture's level.
  void look_for_hidden(const Alignment& a) {
    const Patch& patch = search_.texture_patch();
    const std::size_t n = patch.size();
    hidden_.clear();
    if (!(a.gain > 0)) return;
    seen_.resize(2 * n);
    float *grey = seen_.data(), *inside = grey + n;
    warp(picture_.pyramid().level(search_.texture_level()), camera_, a.G_plane_patch, patch, Interpolation::LINEAR,
         grey, inside);
    const auto gain = static_cast<float>(a.gain), bias = static_cast<float>(a.bias);
    const auto bound = static_cast<float>(kTukey * std::max(kSmallestNoise, a.noise_grey));
    std::size_t count = 0, within = 0;
    hidden_.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      const bool strange = std::abs(gain * grey[i] + bias - patch.grey[i]) > bound && patch.usable[i] > 0;
      hidden_[i] = strange;
      count += strange;
      within += inside[i] > 0;
    }
    const auto share = static_cast<double>(count) / static_cast<double>(n);
    if (share > kFewHidden || share < kSomeHidden || static_cast<double>(within) < 0.9 * static_cast<double>(n))
      hidden_.clear();
  }

  CompositeOptions options_;
  CandidateSearch search_;
  std::unique_ptr<PatchAligner> esm_;
  Camera camera_;
  double side_px_ = 0;
  cv::Mat grey_;  // the frame's own pixels
  SearchPicture picture_;
  HiddenPoints hidden_;
  std::vector<float> seen_;
  const std::vector<Candidate>* candidates_ = nullptr;
  bool searched_ = false, lost_ = false;
  int searched_level_ = 0;
  Eigen::Matrix3d searched_from_ = Eigen::Matrix3d::Identity();
};

}  // namespace

std::unique_ptr<PatchAligner> make_composite_aligner(const CompositeOptions& options, const EsmOptions& esm) {
  return std::make_unique<CompositeAligner>(options, esm);
}

}  // namespace heartservo::tracking
