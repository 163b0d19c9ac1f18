// The region is gone for 1000 frames, in four visits to each of five replacements, and comes back: LOST at once, no false
// OK, found again.
#include <gtest/gtest.h>

#include "tests/sim/sequence/replacement_visits.hpp"

namespace heartservo::test {
namespace {

class Replacement : public testing::TestWithParam<const char*> {
 protected:
  static constexpr int kSide_px = 40;

  static sim::SequenceOptions options(const std::string& texture, int seed) {
    sim::SequenceOptions o = sim::SequenceOptions::named("b");
    o.texture = texture;
    o.seed = seed;
    return o;
  }
};

TEST_P(Replacement, LostAtOnceAndFoundAgain) {
  const FrameLoop loop(options("heart", 1));
  VisitCount all;
  for (const std::string& replacement : replacements()) {
    const bool tissue = replacement != "noise" && replacement != "grey";
    const auto other = tissue ? std::make_unique<FrameLoop>(options(replacement, 71)) : nullptr;
    ReplacedRegion picture(loop, kSide_px, replacement, other.get(), 5);
    VisitCount c;
    count_visits({.gone = 50, .there = 12, .visits = 4}, GetParam(), picture, c);
    ASSERT_EQ(c.refused, "");
    EXPECT_EQ(c.never_lost, 0) << replacement;
    EXPECT_LE(c.to_lost, 3) << replacement;
    EXPECT_EQ(c.false_ok, 0) << replacement;
    EXPECT_EQ(c.never_ok, 0) << replacement;
    EXPECT_LE(c.to_ok, 5) << replacement;
    EXPECT_EQ(c.wrong, 0) << replacement;
    all.frames_gone += c.frames_gone;
  }
  EXPECT_EQ(all.frames_gone, 1000);
}

INSTANTIATE_TEST_SUITE_P(Trackers, Replacement, testing::Values("esm", "composite"),
                         [](const auto& tracker) { return std::string(tracker.param); });

}  // namespace
}  // namespace heartservo::test
