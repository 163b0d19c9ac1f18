#include "sim/sequence/planar_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/message.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::sim {
namespace {

constexpr double kDegree = M_PI / 180;

PlanarView view(const std::string& name, double t) { return sequence_kind(name).view(t); }

TEST(PlanarMotion, BeginsWithTheIdentity) {
  for (const auto& kind : sequence_kinds())
    EXPECT_TRUE(homography_of(kind.view(0), {250, 220}).isApprox(Eigen::Matrix3d::Identity(), 1e-14)) << kind.name;
}

// Where the formulas have their peaks, as published numbers.
TEST(PlanarMotion, AIsFortyPixelsToAndFro) {
  EXPECT_NEAR(view("a", 25).shift_px.x(), 40, 1e-12);
  EXPECT_NEAR(view("a", 75).shift_px.x(), -40, 1e-12);
  EXPECT_NEAR(view("a", 100).shift_px.x(), 0, 1e-12);
  EXPECT_EQ(view("a", 30).shift_px.y(), 0);
  EXPECT_EQ(view("a", 30).angle_rad, 0);
  EXPECT_EQ(view("a", 30).scale, 1);
}

TEST(PlanarMotion, BHasCircleRotationScaleAndPerspective) {
  for (const double t : {0.0, 13.0, 60.0, 150.0})
    EXPECT_NEAR((view("b", t).shift_px + Eigen::Vector2d(30, 0)).norm(), 30, 1e-12);
  EXPECT_NEAR(view("b", 50).shift_px.x(), -60, 1e-12);
  EXPECT_NEAR(view("b", 20).angle_rad, 20 * kDegree, 1e-12);
  EXPECT_NEAR(view("b", 60).angle_rad, -20 * kDegree, 1e-12);
  EXPECT_NEAR(view("b", 67.0 / 4).scale, 1.1, 1e-12);
  EXPECT_NEAR(view("b", 3 * 67.0 / 4).scale, 0.9, 1e-12);
  EXPECT_NEAR(view("b", 22.5).perspective.x(), 2e-4, 1e-15);
  EXPECT_NEAR(view("b", 15).perspective.y(), 1.5e-4, 1e-15);
}

TEST(PlanarMotion, DIsFast) {
  EXPECT_NEAR(view("d", 27.0 / 4).shift_px.x(), 60, 1e-12);
  EXPECT_NEAR(view("d", 41.0 / 4).shift_px.y(), 25, 1e-12);
  EXPECT_NEAR(view("d", 33.0 / 4).angle_rad, 8 * kDegree, 1e-12);
}

TEST(PlanarMotion, StatesItsFastestFrames) {
  const auto fastest = [](const std::string& name) {
    double speed = 0;
    for (int k = 0; k < 150; ++k) speed = std::max(speed, (view(name, k + 1).shift_px - view(name, k).shift_px).norm());
    return speed;
  };
  EXPECT_NEAR(fastest("d"), 14.4, 0.06);
  EXPECT_NEAR(fastest("fast"), 24.9, 0.06);
  EXPECT_NEAR(fastest("table5"), 2.5, 0.02);
}

TEST(PlanarMotion, CdeIsBAndDWithEverythingOn) {
  for (const double t : {7.0, 77.0}) {
    EXPECT_NEAR((view("cde", t).shift_px - view("b", t).shift_px - view("d", t).shift_px).norm(), 0, 1e-12);
    EXPECT_NEAR(view("cde", t).angle_rad, view("b", t).angle_rad + view("d", t).angle_rad, 1e-12);
    EXPECT_EQ(view("c", t).shift_px, view("b", t).shift_px);
    EXPECT_EQ(view("e", t).shift_px, view("b", t).shift_px);
  }
  const auto &c = sequence_kind("c"), &e = sequence_kind("e"), &cde = sequence_kind("cde");
  for (const auto* kind : {&c, &cde}) EXPECT_TRUE(kind->speculars == 16 && kind->noise_grey == 4) << kind->name;
  for (const auto* kind : {&e, &cde}) EXPECT_TRUE(kind->gain == 0.25 && kind->bias_grey == 15) << kind->name;
  EXPECT_EQ(sequence_kind("b").noise_grey, 1);
  EXPECT_EQ(sequence_kind("b").frames, 151);
  EXPECT_EQ(sequence_kind("table5").frames, 100);
  EXPECT_EQ(sequence_kind("table5").frame_rate_hz, 100);
}

TEST(PlanarMotion, HomographyTurnsScalesAndTiltsAboutTheCentre) {
  PlanarView v;
  v.shift_px = {5, -3};
  v.angle_rad = M_PI / 2;
  v.scale = 2;
  const Eigen::Vector2d centre(100, 50);
  const auto moved = [&](const Eigen::Vector2d& p) {
    return Eigen::Vector2d((homography_of(v, centre) * p.homogeneous()).hnormalized());
  };
  EXPECT_NEAR((moved(centre) - Eigen::Vector2d(105, 47)).norm(), 0, 1e-12);
  // x to the right turns to y down: clockwise as seen
  EXPECT_NEAR((moved({110, 50}) - Eigen::Vector2d(105, 67)).norm(), 0, 1e-12);
  v.perspective = {1e-3, 0};
  EXPECT_NEAR((moved({110, 50}) - Eigen::Vector2d(105, 47 + 20 / 1.01)).norm(), 0, 1e-9);
}

TEST(PlanarMotion, SuggestsANearName) {
  EXPECT_NE(test::message_of<ConfigError>([] { sequence_kind("tabel5"); }).find("did you mean 'table5'"),
            std::string::npos);
}

}  // namespace
}  // namespace heartservo::sim
