// The ESM tracker on sequences a and b against exact truth, detail and retina at three places each.
#include <gtest/gtest.h>

#include "servo/loop/score.hpp"
#include "sim/sequence/artificial_sequence.hpp"
#include "tracking/frames/frame.hpp"
#include "tracking/planar/registry.hpp"

namespace heartservo::sim {
namespace {

class EsmGoals : public testing::TestWithParam<const char*> {};

TEST_P(EsmGoals, MeanCornerErrorAtEightyPixels) {
  std::vector<double> errors_px;
  for (const char* texture : {"detail", "retina"}) {
    SequenceOptions options = SequenceOptions::named(GetParam());
    options.texture = texture;
    const auto base = base_picture_of(options);
    for (int place = 0; place < 3; ++place) {
      options.place = place;
      ArtificialSequence sequence(options, base);
      const auto tracker = tracking::trackers().make("esm", tracking::Camera{}, tracking::TrackerOptions{});
      tracking::Frame frame;
      ASSERT_TRUE(sequence.next(frame));
      ASSERT_EQ(tracker->start(frame, sequence.region()), "");
      for (std::size_t k = 1; sequence.next(frame); ++k) {
        const auto track = tracker->track(frame);
        ASSERT_EQ(track.state, tracking::TrackState::OK) << texture << ", place " << place << ", frame " << k;
        const auto truth = sequence.corners(k);
        double error = 0;
        for (std::size_t i = 0; i < 4; ++i) error += (track.corners[i] - truth[i]).norm() / 4;
        EXPECT_LT(error, 0.15) << texture << ", place " << place << ", frame " << k;
        errors_px.push_back(error);
      }
    }
  }
  EXPECT_LE(servo::spread_of(errors_px).mean, 0.027);  // the goal: the noise floor
}

INSTANTIATE_TEST_SUITE_P(Sequences, EsmGoals, testing::Values("a", "b"),
                         [](const auto& sequence) { return std::string(sequence.param); });

}  // namespace
}  // namespace heartservo::sim
