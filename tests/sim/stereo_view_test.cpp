// The simulated stereo endoscope: what its second camera shows lies where the truth says.
#include <gtest/gtest.h>

#include "servo/loop/loop_record.hpp"
#include "sim/scene/scene.hpp"
#include "sim/table/stages.hpp"
#include "sim/table/table.hpp"
#include "tracking/depth/stereo_depth_estimator.hpp"
#include "tracking/landmark/registry.hpp"

namespace heartservo::sim {
namespace {

Scene stereo_scene() {
  Scene scene = load_scene(HEARTSERVO_SOURCE_DIR "/scenes/stereo.yaml");
  scene.duration_s = 0.5;
  scene.settle_s = 0;
  scene.camera.frame_rate_hz = 10;
  scene.show_tool = false;
  return scene;
}

TEST(StereoView, ShowsTheRegionAtItsTrueDepth) {
  const Scene scene = stereo_scene();
  const auto table = make_table(scene);
  ASSERT_TRUE(table->stereo());
  EXPECT_NEAR(table->stereo()->baseline_m(), scene.stereo.baseline_m, 1e-12);
  tracking::StereoDepthEstimator estimator(*table->stereo(), scene.stereo.matching, scene.tracking.corner_sigma_px);
  servo::LoopRecord record;
  int count = 0;
  while (table->frames().next(record.frame)) {
    ASSERT_EQ(record.frame.right.size(), record.frame.grey.size());
    const auto truth = table->truth(record);
    tracking::Track track;
    track.state = tracking::TrackState::OK;
    track.corners = *truth.corners_px;
    estimator.look_at(record.frame);
    const auto state = estimator.estimate(track);
    ASSERT_EQ(state.state, tracking::TrackState::OK) << name_of(estimator.last_match().failure);
    EXPECT_NEAR(state.T_camera_target.translation().z(), truth.target->z(), 3e-4);
    EXPECT_LT(std::abs(estimator.last_match().epipolar_px), 0.2);
    ++count;
  }
  EXPECT_EQ(count, 5);
}

TEST(StereoView, ALongerBaselineMovesThePictureFurther) {
  Scene scene = stereo_scene();
  const auto shift = [&](double baseline_m) {
    scene.stereo.baseline_m = baseline_m;
    servo::LoopRecord record;
    const auto table = make_table(scene);
    table->frames().next(record.frame);
    return cv::norm(record.frame.grey, record.frame.right, cv::NORM_L1);
  };
  EXPECT_LT(shift(1e-4), shift(1e-3));
}

TEST(Scale, ComesFromEachOfItsSources) {
  for (const char* source : {"distance", "landmark", "stereo"}) {
    Scene scene = stereo_scene();
    scene.engines.estimator = "region_depth";
    scene.depth.source = source;
    scene.surface.landmarks = {{-0.01, 0, 0.005, 0}};
    require_valid(scene, source);
    const auto table = make_table(scene);
    servo::LoopRecord record;
    ASSERT_TRUE(table->frames().next(record.frame));
    const auto truth = table->truth(record);
    tracking::Track region;
    region.state = tracking::TrackState::OK;
    region.corners = *truth.corners_px;
    region.target = table->camera().project(*truth.target);
    const auto scale = table->picked().scale(record.frame, region);
    EXPECT_TRUE(scale.validate().empty()) << source;
    // the landmark is 10 mm away on curved tissue
    EXPECT_NEAR(scale.depth_m, truth.target->z(), source == std::string("landmark") ? 2.5e-3 : 8e-4) << source;
  }
}

TEST(Scale, WhatASceneLacksIsNamed) {
  const auto problem = [](auto&& change) {
    Scene scene = stereo_scene();
    change(scene);
    const auto problems = scene.validate();
    return problems.empty() ? std::string() : problems[0];
  };
  EXPECT_EQ(problem([](Scene&) {}), "");
  EXPECT_NE(problem([](Scene& s) { s.stereo.baseline_m = 0; }).find("stereo.baseline_m"), std::string::npos);
  const auto region = [](Scene& s, const char* source) {
    s.engines.estimator = "region_depth";
    s.depth.source = source;
  };
  EXPECT_NE(problem([&](Scene& s) { region(s, "landmark"); }).find("depth.landmark"), std::string::npos);
  EXPECT_NE(problem([&](Scene& s) { s.depth.assumed.wander_length_m = NAN; }).find("depth.wander_length_m"),
            std::string::npos);
  EXPECT_NE(problem([](Scene& s) { s.more_targets = {{3}}; }).find("more_targets[0]"), std::string::npos);
}

}  // namespace
}  // namespace heartservo::sim
