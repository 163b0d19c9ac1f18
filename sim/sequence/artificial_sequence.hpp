#pragma once
// A planar region whose motion is known exactly: frame k shows the first frame's scene under the homography H(k). The
// pixels are samples of one continuous picture, so the truth holds to a ten-thousandth of a pixel.
#include <Eigen/Core>
#include <memory>

#include "sim/endoscope/noise_table.hpp"
#include "sim/sequence/base_picture.hpp"
#include "sim/sequence/moving_glare.hpp"
#include "sim/sequence/picture_sampler.hpp"
#include "sim/sequence/sequence_options.hpp"
#include "tracking/frames/frame_source.hpp"
#include "tracking/planar/quad.hpp"

namespace heartservo::sim {

/// The picture that the options name, drawn from their seed.
std::shared_ptr<const BasePicture> base_picture_of(const SequenceOptions& options);

class ArtificialSequence final : public tracking::FrameSource {
 public:
  /// Throws ConfigError (options), InputError (files). `base`: base_picture_of(options), to share it among sequences.
  explicit ArtificialSequence(const SequenceOptions& options, std::shared_ptr<const BasePicture> base = nullptr);
  ~ArtificialSequence() override;

  /// A new picture each time. Rows are made on several cores; the result does not depend on their number.
  bool next(tracking::Frame& frame) override;
  cv::Size size() const override { return size_; }
  double frame_rate_hz() const override { return options_.frame_rate_hz; }
  std::optional<std::size_t> frame_count() const override { return static_cast<std::size_t>(options_.frames); }
  std::string description() const override;

  const SequenceOptions& options() const { return options_; }

  /// The truth of frame k. The first frame's region has whole-numbered corners; gain and bias are those of the light.
  tracking::Quad region() const { return region_; }
  PlanarView view(std::size_t k) const;
  Eigen::Matrix3d H_current_reference(std::size_t k) const;
  tracking::Quad corners(std::size_t k) const;

 private:
  struct Background;

  void paint_row(std::size_t k, const Eigen::Matrix3d& H_reference_current, const cv::Mat& background, int v,
                 float* grey) const;
  void lay_patch(const Eigen::Matrix3d& H_reference_current, int v, float* grey) const;

  SequenceOptions options_;
  const SequenceKind& kind_;
  std::unique_ptr<Background> background_;  // of patch sequences
  cv::Size size_;
  tracking::Quad region_;
  std::shared_ptr<const BasePicture> base_;
  PictureSampler sampler_;
  MovingGlare glare_;
  NoiseTable noise_;
  std::size_t count_ = 0;
};

/// Centre of the region at place 0, 1 or 2 of a picture, whole px, chosen so that no sequence leaves 512 x 512 px with
/// a region of 120 px.
Eigen::Vector2d place_px(int place, cv::Size picture);

}  // namespace heartservo::sim
