// Metric pose on the command line: choice of the estimator, the landmark's picture, the experiment on depth.
#include "tests/tools/command/command_fixture.hpp"

namespace heartservo::test {
namespace {

class Pose : public CommandLine {};

TEST_F(Pose, TheDepthExperimentStandsBesideThePaper) {
  const Outcome o = run({"track", scene("depth_rail"), "--frames", "4", "--out", "rail"});
  EXPECT_EQ(o.code, 0) << o.err;
  for (const char* part : {"paper", "0.34", "0.8", "landmark_linear", "landmark_refined", "landmark_dense", "laser"})
    EXPECT_NE(o.out.find(part), std::string::npos) << part;
  expect_complete("rail");
  const auto summary = summary_of("rail");
  EXPECT_EQ(summary["frames"], 20);
  EXPECT_EQ(summary["paper"][0]["rows"].size(), 18u);
  EXPECT_EQ(summary["paper"][0]["paper_mm"]["std"], 0.34);
  expect_refused(2, {"track", scene("depth_rail"), "--tracker", "esm,ssd"}, {"tracker"});
  expect_refused(2, {"track", scene("depth_rail"), "--estimator", "landmark_dense"}, {"--estimator"});
}

TEST_F(Pose, TheLandmarksPictureMakesTheDensePose) {
  ASSERT_EQ(run({"render", scene("pig_2007"), "--frames", "8", "--out", "rendered", "--quiet"}).code, 0);
  const std::vector<std::string> track{"track",     "rendered/frames",
                                       "--camera",  "rendered/camera.yaml",
                                       "--corners", "244,230,301,230,301,287,244,287",
                                       "--quiet",   "--square-mm",
                                       "5"};
  const auto with = [&](std::vector<std::string> more) {
    auto all = track;
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  for (const char* name : {"landmark_refined", "landmark_dense", "landmark_linear", "landmark_visp"})
    EXPECT_EQ(run(with({"--estimator", name, "--out", name})).code, 0) << name;
  EXPECT_EQ(run(with({"--estimator", "landmark_dense", "--landmark", "rendered/landmark.png", "--out", "told"})).code, 0);
  // corners rounded to whole pixels: told what was printed, the pose is right all the same
  std::istringstream trajectory(read_text(folder_ / "told/trajectory_esm.tum"));
  double t, x, y, z;
  ASSERT_TRUE(trajectory >> t >> x >> y >> z);
  std::istringstream truth(read_text(folder_ / "rendered/truth.csv"));
  std::string line;
  std::getline(truth, line);
  std::getline(truth, line);
  const auto at = line.rfind(',');
  EXPECT_NEAR(z, std::stod(line.substr(at + 1)), 1.5e-4);

  expect_refused(2, with({"--estimator", "landmark_dens"}), {"landmark_dens", "landmark_dense"});
  expect_refused(2, with({"--landmark", "rendered/landmark.png"}), {"--landmark", "landmark_dense"});
  expect_refused(3, with({"--estimator", "landmark_dense", "--landmark", "nowhere.png"}), {"nowhere.png"});
  cv::imwrite(folder_ / "tall.png", waves(0));
  expect_refused(2, with({"--estimator", "landmark_dense", "--landmark", "tall.png"}), {"square"});
  expect_refused(2, {"track", "rendered/frames", "--roi", "232,223,54,54", "--estimator", "landmark_dense"},
                 {"--square-mm"});
}

}  // namespace
}  // namespace heartservo::test
