#include "sim/sequence/artificial_sequence.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/endoscope/shading.hpp"
#include "sim/scene/scene.hpp"
#include "sim/table/table.hpp"
#include "tracking/frames/frame.hpp"
#include "tracking/frames/open_source.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::sim {

namespace {

constexpr int kSize = 512;     // px, where the whole picture moves
constexpr int kPatchRim = 10;  // px of the patch around the region

// Each consumer of randomness has its own stream of the seed.
enum class Stream : std::uint64_t { TEXTURE = 1, GLARE, NOISE };
std::uint64_t stream_seed(int seed, Stream stream) {
  return static_cast<std::uint64_t>(seed) * 1000003ULL + static_cast<std::uint64_t>(stream);
}

const SequenceOptions& valid(const SequenceOptions& options) {
  const auto problems = options.validate();
  if (!problems.empty())
    throw ConfigError(fmt::format("artificial sequence {}: {}", options.sequence, fmt::join(problems, "; ")));
  return options;
}

// The simulated heart without tool and noise.
Scene heart_scene(const SequenceOptions& options) {
  Scene scene;
  scene.title = "simulated heart";
  scene.seed = options.seed;
  scene.camera.frame_rate_hz = options.frame_rate_hz;
  scene.duration_s = (options.frames + 1) / options.frame_rate_hz;
  scene.settle_s = 0;
  scene.target.landmark = -1;
  scene.picture.noise_grey = 0;
  scene.show_tool = false;
  return scene;
}

}  // namespace

struct ArtificialSequence::Background {
  std::unique_ptr<Table> heart;
  std::unique_ptr<tracking::FrameSource> recorded;

  explicit Background(const SequenceOptions& options) {
    if (options.background.empty())
      heart = make_operating_table(heart_scene(options));
    else
      recorded = tracking::open_source(options.background, options.frame_rate_hz);
  }
  tracking::FrameSource& frames() { return heart ? heart->frames() : *recorded; }
};

Eigen::Vector2d place_px(int place, cv::Size picture) {
  constexpr double kPlaces[3][2] = {{0.50, 0.44}, {0.66, 0.36}, {0.58, 0.66}};
  return {std::round(kPlaces[place][0] * picture.width), std::round(kPlaces[place][1] * picture.height)};
}

std::shared_ptr<const BasePicture> base_picture_of(const SequenceOptions& options) {
  return std::make_shared<BasePicture>(make_base_picture(options.texture, stream_seed(options.seed, Stream::TEXTURE)));
}

ArtificialSequence::ArtificialSequence(const SequenceOptions& options, std::shared_ptr<const BasePicture> base)
    : options_(valid(options)),
      kind_(sequence_kind(options.sequence)),
      background_(kind_.patch ? std::make_unique<Background>(options) : nullptr),
      size_(background_ ? background_->frames().size() : cv::Size(kSize, kSize)),
      base_(base ? std::move(base) : base_picture_of(options)),
      sampler_(base_->grey, base_->texels_per_px, {0.5 * (size_.width - 1), 0.5 * (size_.height - 1)}),
      glare_(options.speculars, place_px(options.place, size_), stream_seed(options.seed, Stream::GLARE)),
      noise_(options.noise_grey, size_.width, stream_seed(options.seed, Stream::NOISE)) {
  const double side = options_.side_px, half = std::floor(side / 2);
  const Eigen::Vector2d middle = place_px(options_.place, size_);
  region_ = tracking::rectangle(middle.x() - half, middle.y() - half, side, side);
}

ArtificialSequence::~ArtificialSequence() = default;

std::string ArtificialSequence::description() const {
  return fmt::format("artificial {}: {}, {} px, place {}, seed {}", options_.sequence, options_.texture,
                     options_.side_px, options_.place, options_.seed);
}

PlanarView ArtificialSequence::view(std::size_t k) const {
  const double t = static_cast<double>(k) * options_.step;
  PlanarView view = kind_.view(t);
  view.gain = 1 + options_.gain * std::sin(2 * M_PI * t / 45);
  view.bias = options_.bias_grey * std::sin(2 * M_PI * t / 30);
  return view;
}

Eigen::Matrix3d ArtificialSequence::H_current_reference(std::size_t k) const {
  return homography_of(view(k), place_px(options_.place, size_));
}

tracking::Quad ArtificialSequence::corners(std::size_t k) const {
  return tracking::transform(H_current_reference(k), region_);
}

// The patch is the region with a rim around it, its edge one pixel wide.
void ArtificialSequence::lay_patch(const Eigen::Matrix3d& H_reference_current, int v, float* grey) const {
  const Eigen::Vector2d centre = tracking::centre(region_);
  const double half = 0.5 * options_.side_px + kPatchRim;
  std::vector<float> share(static_cast<std::size_t>(size_.width));
  int from = size_.width, to = -1;
  for (int u = 0; u < size_.width; ++u) {
    const Eigen::Vector2d p = (H_reference_current * Eigen::Vector3d(u, v, 1)).hnormalized() - centre;
    share[u] = static_cast<float>(std::clamp(half + 0.5 - p.cwiseAbs().maxCoeff(), 0.0, 1.0));
    if (share[u] > 0) from = std::min(from, u), to = u;
  }
  if (to < from) return;
  std::vector<float> patch(static_cast<std::size_t>(to - from + 1));
  sampler_.row(H_reference_current, from, v, to - from + 1, patch.data());
  for (int u = from; u <= to; ++u) grey[u] += share[u] * (patch[static_cast<std::size_t>(u - from)] - grey[u]);
}

void ArtificialSequence::paint_row(std::size_t k, const Eigen::Matrix3d& H_reference_current, const cv::Mat& background,
                                   int v, float* grey) const {
  if (background_) {
    std::copy_n(background.ptr<std::uint8_t>(v), size_.width, grey);
    lay_patch(H_reference_current, v, grey);
  } else {
    sampler_.row(H_reference_current, 0, v, size_.width, grey);
  }
  glare_.add_to_row(static_cast<double>(k) * options_.step, v, size_.width, grey);
}

bool ArtificialSequence::next(tracking::Frame& frame) {
  if (count_ >= static_cast<std::size_t>(options_.frames)) return false;
  tracking::Frame under;
  if (background_) {
    if (!background_->frames().next(under)) return false;  // a recorded sequence may be shorter
    if (under.status != tracking::FrameStatus::OK) throw InputError("background: " + under.note);
    if (under.grey.size() != size_) throw InputError("background: its frames change their size");
  }
  const std::size_t k = count_++;
  const PlanarView seen = view(k);
  const Eigen::Matrix3d H_reference_current = H_current_reference(k).inverse();
  frame = tracking::Frame{};
  frame.grey.create(size_, CV_8UC1);
  frame.sequence = k;
  frame.time_s = static_cast<double>(k) / options_.frame_rate_hz;
  const auto gain = static_cast<float>(seen.gain), bias = static_cast<float>(seen.bias);
  tbb::parallel_for(tbb::blocked_range<int>(0, size_.height, 32), [&](const tbb::blocked_range<int>& rows) {
    std::vector<float> grey(static_cast<std::size_t>(size_.width));
    for (int v = rows.begin(); v < rows.end(); ++v) {
      paint_row(k, H_reference_current, under.grey, v, grey.data());
      expose_row(grey.data(), noise_.row(k, v), gain, bias, size_.width, frame.grey.ptr<std::uint8_t>(v));
    }
  });
  return true;
}

}  // namespace heartservo::sim
