// The dense pose reaches what the picture can tell: 200 poses in the working volume, the paper's camera, grey noise 3.
#include <gtest/gtest.h>

#include <cstdio>

#include "tests/sim/dense_goals.hpp"
#include "tests/support/random.hpp"
#include "tests/support/table2_camera.hpp"

namespace heartservo::test {
namespace {

TEST(DensePoseGoals, ReachesTheBoundOfTheSimulatedPicture) {
#ifdef HEARTSERVO_SANITIZED
  constexpr int kPoses = 30;
#else
  constexpr int kPoses = 200;
#endif
  auto random = seeded();
  const DenseGoals g = dense_goals(table2_camera(), random, kPoses, 0, M_PI / 4, 3, 0.1);
  std::printf("z std %.4f max %.4f mm, mean %.4f; x, y std %.4f, %.4f mm; bound of z %.4f (%.4f at most), x %.4f\n",
              1e3 * g.z.std, 1e3 * g.z.max, 1e3 * g.z.mean, 1e3 * g.x.std, 1e3 * g.y.std, 1e3 * g.bound_z.rms,
              1e3 * g.bound_z.max, 1e3 * g.bound_x.rms);
  std::printf("error / bound %.2f %.2f %.2f, %.2f %.2f %.2f; chi2 / 6 n %.3f, / 3 n %.3f; misfit %.2f (median) %.2f grey (95 %%)\n",
              g.over_bound(0), g.over_bound(1), g.over_bound(2), g.over_bound(3), g.over_bound(4), g.over_bound(5),
              g.chi2_pose / (6 * g.poses), g.chi2_position / (3 * g.poses), servo::percentile(g.misfit_grey, 50), servo::percentile(g.misfit_grey, 95));
  EXPECT_EQ(g.invalid, 0);
  EXPECT_LE(g.z.std, 0.05e-3);
  EXPECT_LE(g.z.max, 0.20e-3);
  EXPECT_LE(g.x.std, 0.01e-3);
  EXPECT_LE(g.y.std, 0.01e-3);
  // measured 2.6 (median) and 3.7: glare and a light that is not quite quadratic; another pattern or blur is far off
  EXPECT_LT(servo::percentile(g.misfit_grey, 95), 5) << "the bound is that of another picture";
  for (int k = 0; k < 6; ++k) {
    EXPECT_LE(g.over_bound(k), 1.5) << k;
    EXPECT_GT(g.over_bound(k), 0.8) << k << ": below the bound, which is then wrong";
  }
  EXPECT_NEAR(g.chi2_pose, 6 * g.poses, 4 * std::sqrt(2.0 * 6 * g.poses));
  EXPECT_NEAR(g.chi2_position, 3 * g.poses, 4 * std::sqrt(2.0 * 3 * g.poses));
}

}  // namespace
}  // namespace heartservo::test
