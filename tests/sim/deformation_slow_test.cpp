// Tissue that bends strongly: the deformable tracker keeps the target point where a homography cannot.
#include <gtest/gtest.h>

#include "servo/loop/loop_record.hpp"
#include "servo/loop/score.hpp"
#include "sim/scene/scene.hpp"
#include "sim/table/table.hpp"
#include "tracking/frames/frame.hpp"
#include "tracking/planar/registry.hpp"

namespace heartservo::sim {
namespace {

struct Outcome {
  std::size_t lost = 0, uncertain = 0;
  servo::Spread target_px;  // over frames that are not LOST
};

Outcome follow(const std::string& tracker_name, Scene scene) {
  scene.show_tool = false;
  const auto table = make_table(scene);
  const auto tracker = tracking::trackers().make(tracker_name, table->camera(), scene.tracking);
  servo::LoopRecord record;
  EXPECT_TRUE(table->frames().next(record.frame));
  EXPECT_EQ(tracker->start(record.frame, table->picked().target), "");
  const Eigen::Vector2d start = table->camera().project(*table->truth(record).target);
  Outcome outcome;
  std::vector<double> errors_px;
  while (table->frames().next(record.frame)) {
    const auto track = tracker->track(record.frame);
    outcome.lost += track.state == tracking::TrackState::LOST;
    outcome.uncertain += track.state == tracking::TrackState::UNCERTAIN;
    const auto truth = table->truth(record);
    const double error = (tracker->carry(start) - table->camera().project(*truth.target)).norm();
    if (track.state != tracking::TrackState::LOST) errors_px.push_back(error);
  }
  outcome.target_px = servo::spread_of(errors_px);
  return outcome;
}

Scene deforming() {
  Scene scene = load_scene(HEARTSERVO_SOURCE_DIR "/scenes/deformation.yaml");
  scene.duration_s = 0.9;  // a beat is 0.84 s
  return scene;
}

TEST(DeformingTissue, TheDeformableTrackerKnowsTheTargetToATenthOfAPixelWhereAHomographyMissesByOne) {
  const Outcome bent = follow("deformable", deforming());
  EXPECT_EQ(bent.lost, 0U);
  EXPECT_LE(bent.target_px.mean, 0.1);
  EXPECT_GT(follow("esm", deforming()).target_px.mean, 1);
}

// Bulges so steep that the shading of the tissue changes as much as its shape.
TEST(DeformingTissue, TheDeformableTrackerHoldsWhereAHomographyFails) {
  Scene scene = deforming();
  scene.surface.bulge_m = 0.002;
  scene.target.side_m = 0.008;
  const Outcome bent = follow("deformable", scene);
  EXPECT_EQ(bent.lost, 0U);
  EXPECT_LE(bent.target_px.mean, 0.6);
  const Outcome flat = follow("esm", scene);
  EXPECT_GT(flat.lost + flat.uncertain, 10U) << "it must not call this OK";
  EXPECT_GT(flat.target_px.mean, 3 * bent.target_px.mean);
}

}  // namespace
}  // namespace heartservo::sim
