// Depth without landmark, stereo endoscopes and several regions, from the command line.
#include <opencv2/imgproc.hpp>

#include "tests/tools/command/command_fixture.hpp"

namespace heartservo::test {
namespace {

using nlohmann::json;

class Depth : public CommandLine {
 protected:
  // A stereo endoscope of waves: the right view is the left one 20 px to the left, a plane at 50 mm.
  void stereo_frames(int left, int right) const {
    fs::create_directories(folder_ / "left");
    fs::create_directories(folder_ / "right");
    for (int i = 0; i < left; ++i) cv::imwrite(picture("left", i), tissue(0.5 * i));
    for (int i = 0; i < right; ++i) cv::imwrite(picture("right", i), tissue(0.5 * i - 20));
    write_text(folder_ / "stereo.yaml", stereo_file("-5."));
    write_text(folder_ / "mono.yaml", "%YAML:1.0\n---\nimage_width: 160\nimage_height: 120\n" + camera("camera_matrix", "distortion_coefficients"));
  }

  static cv::Mat tissue(double shift) {
    cv::Mat picture(120, 160, CV_8UC1);
    for (int v = 0; v < 120; ++v)
      for (int u = 0; u < 160; ++u) {
        const double x = u - shift;
        picture.at<std::uint8_t>(v, u) = cv::saturate_cast<std::uint8_t>(
            125 + 40 * std::sin(x / 4.3 + 0.01 * v * v / 7) * std::cos(v / 5.0) + 25 * std::sin(0.004 * x * x + v / 6.1) +
            15 * std::sin(x / 2.7 - v / 3.3));
      }
    return picture;
  }

  static std::string camera(const std::string& matrix, const std::string& distortion) {
    const auto data = [](int rows, int columns, const std::string& values) {
      return fmt_matrix(rows, columns, values);
    };
    return matrix + data(3, 3, "200., 0., 80., 0., 200., 60., 0., 0., 1.") + distortion + data(1, 5, "0., 0., 0., 0., 0.");
  }
  static std::string fmt_matrix(int rows, int columns, const std::string& values) {
    return ": !!opencv-matrix\n   rows: " + std::to_string(rows) + "\n   cols: " + std::to_string(columns) +
           "\n   dt: d\n   data: [ " + values + " ]\n";
  }
  static std::string stereo_file(const std::string& baseline_mm) {
    return "%YAML:1.0\n---\nimage_width: 160\nimage_height: 120\n" + camera("M1", "D1") + camera("M2", "D2") + "R" +
           fmt_matrix(3, 3, "1., 0., 0., 0., 1., 0., 0., 0., 1.") + "T" + fmt_matrix(3, 1, baseline_mm + ", 0., 0.") +
           "length_unit: \"mm\"\n";
  }

  static std::vector<std::string> stereo_run(std::vector<std::string> more = {}) {
    std::vector<std::string> arguments{"track", "left", "--stereo", "right", "--camera", "stereo.yaml",
                                       "--roi", "70,40,40,40"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
};

TEST_F(Depth, AStereoEndoscopeMeasuresIt) {
  stereo_frames(4, 4);
  const Outcome o = run(stereo_run({"--json", "--out", "run"}));
  ASSERT_EQ(o.code, 0) << o.err;
  std::istringstream tum(read_text(folder_ / "run/trajectory_esm.tum"));
  int rows = 0;
  for (double t, x, y, z, q[4]; tum >> t >> x >> y >> z >> q[0] >> q[1] >> q[2] >> q[3]; ++rows)
    EXPECT_NEAR(z, 0.05, 5e-4);
  EXPECT_EQ(rows, 4);
  const Outcome servo = run({"servo", "left", "--stereo", "right", "--camera", "stereo.yaml", "--roi", "90,75,40,40",
                             "--json", "--quiet", "--out", "loop"});
  EXPECT_EQ(servo.code, 0) << servo.err;
  EXPECT_EQ(json_of(servo)["estimator"], "stereo_depth");
}

TEST_F(Depth, WhatAStereoRunLacksIsNamed) {
  stereo_frames(4, 3);
  expect_refused(3, stereo_run(), {"right", "3 frames", "pairs"});
  stereo_frames(4, 4);
  expect_refused(2, {"track", "left", "--stereo", "right", "--roi", "70,40,40,40"}, {"--camera", "stereo calibration"});
  expect_refused(3, {"track", "left", "--stereo", "right", "--camera", "mono.yaml", "--roi", "70,40,40,40"},
                 {"mono.yaml", "no stereo calibration"});
  expect_refused(3, {"track", "left", "--stereo", "nowhere", "--camera", "stereo.yaml"}, {"nowhere"});
  expect_refused(3, {"track", "left", "--stereo", "right", "--camera", "none.yaml"}, {"none.yaml"});
  write_text(folder_ / "stereo.yaml", stereo_file(".nan"));
  expect_refused(3, stereo_run(), {"stereo.yaml", "T"});
  expect_refused(2, {"track", scene("pig_2007"), "--stereo", "right"}, {"--stereo", "stereo.baseline_m"});
}

TEST_F(Depth, SeveralRegionsEachHaveTheirOwn) {
  const std::string source = sequence("frames", 6);
  const Outcome o = run({"track", source, "--roi", "30,30,40,40", "--roi", "90,40,40,40", "--json", "--out", "run"});
  ASSERT_EQ(o.code, 0) << o.err;
  const json j = json_of(o);
  ASSERT_EQ(j["trackers"].size(), 2u);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(j["trackers"][i]["region"], i + 1);
    EXPECT_EQ(j["trackers"][i]["name"], "region" + std::to_string(i + 1));
    EXPECT_TRUE(fs::exists(folder_ / ("run/frames_region" + std::to_string(i + 1) + ".csv")));
  }
  EXPECT_NE(read_text(folder_ / "run/report.html").find("region2"), std::string::npos);
  expect_complete("run");
  const json both = json_of(run({"track", source, "--corners", "30,30,70,30,70,70,30,70", "--corners",
                                 "90,40,130,40,130,80,90,80", "--tracker", "esm,ssd", "--json"}));
  ASSERT_EQ(both["trackers"].size(), 4u);
  EXPECT_EQ(both["trackers"][3]["name"], "region2_ssd");
}

TEST_F(Depth, TwoLandmarksHaveTwoTrajectories) {
  const Outcome o = run({"track", scene("two_landmarks"), "--frames", "20", "--json", "--out", "run"});
  ASSERT_EQ(o.code, 0) << o.err;
  const json j = json_of(o);
  ASSERT_EQ(j["trackers"].size(), 2u);
  for (int i = 0; i < 2; ++i) {
    EXPECT_LT(j["trackers"][i]["error_px"]["max"], 0.5);
    EXPECT_LT(j["trackers"][i]["position_error_mm"]["z"]["rms"], 0.1);
    EXPECT_TRUE(fs::exists(folder_ / ("run/trajectory_region" + std::to_string(i + 1) + ".tum")));
  }
}

TEST_F(Depth, ARegionOutOfThePictureIsNamedByItsNumber) {
  const std::string source = sequence("frames", 2);
  expect_refused(2, {"track", source, "--roi", "30,30,40,40", "--roi", "150,40,40,40"},
                 {"region 2", "outside the picture"});
  expect_refused(2, {"track", source, "--roi", "30,30,40,40", "--roi", "90,40,40"}, {"--roi", "4 numbers"});
}

TEST_F(Depth, ADistanceThatCannotBeIsNamed) {
  const std::string source = sequence("frames", 2);
  expect_refused(2, {"servo", source, "--roi", "30,30,40,40", "--depth-mm", "0"}, {"--depth-mm"});
  expect_refused(2, {"servo", source, "--roi", "30,30,40,40", "--depth-mm=-5"}, {"--depth-mm"});
  const std::string own = edited_scene({{"estimator: landmark_refined", "estimator: region_depth"},
                                        {"robot:\n", "depth: {source: landmark, landmark: 4}\nrobot:\n"}});
  expect_refused(2, {"servo", own}, {"depth.landmark", "4"});
}

TEST_F(Depth, OfBareTissueIsScoredAgainstTheTruth) {
  const json j = json_of(run({"track", scene("texture_only"), "--tracker", "esm", "--frames", "12", "--json"}));
  const json& error = j["trackers"][0]["position_error_mm"];
  EXPECT_LT(error["z"]["rms"], 0.5);
  EXPECT_GT(error["normalised_z"], 0);
}

}  // namespace
}  // namespace heartservo::test
