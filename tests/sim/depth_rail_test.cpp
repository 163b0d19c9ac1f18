#include "sim/experiment/depth_rail.hpp"

#include <gtest/gtest.h>

#include "sim/scene/scene.hpp"

namespace heartservo::sim {
namespace {

Scene rail(std::vector<double> tilts_rad, std::size_t frames) {
  Scene scene = load_scene(HEARTSERVO_SOURCE_DIR "/scenes/depth_rail.yaml");
  scene.depth_rail.tilts_rad = std::move(tilts_rad);
  scene.duration_s = static_cast<double>(frames) / 25;
  scene.camera.frame_rate_hz = 25;
  return scene;
}

TEST(DepthRail, DenseIsBetterThanCornersAndTheLaserIsWhatLimitsTheComparison) {
  const Scene scene = rail({0, 0.524}, 20);
  std::size_t calls = 0;
  const auto rows = run_depth_rail(scene, [&](std::size_t done) {
    EXPECT_EQ(done, ++calls);
    return true;
  });
  EXPECT_EQ(calls, 40u);
  ASSERT_EQ(rows.size(), 9u);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto& r = rows[i];
    EXPECT_EQ(r.estimator, depth_rail_estimators()[i % 3]);
    EXPECT_EQ(r.all_tilts, i >= 6);
    EXPECT_EQ(r.frames, r.all_tilts ? 40u : 20u);
    EXPECT_EQ(r.lost, 0u);
    EXPECT_EQ(r.z.count, r.frames);
    // readings within 0.5 mm, evenly: a standard deviation of 0.29 mm
    EXPECT_LT(r.against_laser.max, 0.5e-3 + r.z.max);
    EXPECT_GT(r.against_laser.std, 0.2e-3);
  }
  EXPECT_LT(rows[8].z.std, 0.05e-3);
  EXPECT_LT(rows[8].z.max, 0.2e-3);
  EXPECT_LT(rows[8].z.rms, rows[6].z.rms);
}

TEST(DepthRail, EndsEarlyWithWhatThereIs) {
  const auto rows = run_depth_rail(rail({0, 0.2}, 20), [](std::size_t done) { return done < 5; });
  ASSERT_EQ(rows.size(), 6u);
  EXPECT_EQ(rows[0].frames, 5u);
  EXPECT_EQ(rows[3].frames, 5u);
}

TEST(DepthRail, AnotherSceneCannotHoldTheExperiment) {
  Scene scene = rail({0}, 5);
  EXPECT_TRUE(scene.validate().empty());
  scene.motion.profile = "sharp";
  EXPECT_EQ(scene.validate().size(), 1u);
  scene.motion.profile = "rail";
  scene.target.landmark = -1;
  EXPECT_EQ(scene.validate().size(), 1u);
}

}  // namespace
}  // namespace heartservo::sim
