// track and servo scored on annotated points, and points files that are wrong.
#include <sstream>

#include "tests/tools/command/command_fixture.hpp"

namespace heartservo::test {
namespace {

using nlohmann::json;

class TrackPoints : public CommandLine {
 protected:
  // `count` frames of waves that move by half a pixel a frame, and their points: `vein` and `spot` inside 50,30,40,40.
  void SetUp() override {
    sequence("frames", kFrames);
    std::ostringstream points;
    points << "frame,point,u_px,v_px,visible\n";
    for (int k = 0; k < kFrames; ++k)
      points << k + 1 << ",vein," << 68.0 + 0.5 * k << ",52,1\n"
             << k + 1 << ",spot," << 60.0 + 0.5 * k << ",40," << (k == 3 ? 0 : 1) << "\n"
             << k + 1 << ",far," << 140 << ",100,1\n"
             << k + 2 << ",late,70,50,1\n";
    write_text(folder_ / "points.csv", points.str());
  }
  std::vector<std::string> track(const std::vector<std::string>& more) const {
    std::vector<std::string> line{"track", "frames", "--roi", "50,30,40,40"};
    line.insert(line.end(), more.begin(), more.end());
    return line;
  }

  static constexpr int kFrames = 10;
};

TEST_F(TrackPoints, ScoresThePointNearestToTheMiddle) {
  const Outcome o = run(track({"--points", "points.csv", "--tracker", "esm,correlation", "--json", "--out", "run"}));
  ASSERT_EQ(o.code, 0) << o.err;
  const json j = json_of(o);
  EXPECT_EQ(j["reference"], "points.csv");
  EXPECT_EQ(j["point"], "vein");
  ASSERT_EQ(j["trackers"].size(), 2u);
  for (const json& lane : j["trackers"]) {
    const json& e = lane["point_error_px"];
    EXPECT_EQ(e["name"], "vein");
    EXPECT_EQ(e["frames"], kFrames);
    EXPECT_EQ(e["visible_frames"], kFrames);
    for (const char* key : {"median", "p95", "mean", "std", "max"}) {
      ASSERT_TRUE(e[key].is_number()) << key;
      EXPECT_LT(e[key], 0.3) << key;
    }
    EXPECT_TRUE(e["with_lost"]["p95"].is_number());
    EXPECT_EQ(lane["wrong_ok_frames"], 0);
    EXPECT_EQ(lane["wrong_over_px"], (json{{"point", 8}}));
    EXPECT_TRUE(lane["error_px"].is_null());
    EXPECT_TRUE(lane["first_failure"].is_null());
  }
  for (const char* file : {"run/frames.csv", "run/frames_esm.csv", "run/frames_correlation.csv"}) {
    const std::string csv = read_text(folder_ / file);
    for (const char* column :
         {",target/u_px,target/v_px,", ",point/u_px,point/v_px,truth/point/u_px,truth/point/v_px,point/error_px\n"})
      EXPECT_NE(csv.find(column), std::string::npos) << file << column;
  }
  const std::string page = read_text(folder_ / "run/report.html");
  EXPECT_NE(page.find("annotated point vein"), std::string::npos);
  const Outcome text = run(track({"--points", "points.csv", "--out", "run"}));
  EXPECT_NE(text.out.find("point px"), std::string::npos) << text.out;
}

TEST_F(TrackPoints, ScoresTheNamedPointWhereItIsVisible) {
  const json lane = json_of(run(track({"--points", "points.csv", "--point", "spot", "--json"})))["trackers"][0];
  EXPECT_EQ(lane["point_error_px"]["name"], "spot");
  EXPECT_EQ(lane["point_error_px"]["frames"], kFrames - 1);
  EXPECT_LT(lane["point_error_px"]["max"], 0.3);
}

TEST_F(TrackPoints, TimesServeInPlaceOfFrames) {
  std::ostringstream points;
  points << "time_s,u_px,v_px\n";
  for (int k = 0; k < kFrames; ++k) points << k / 25.0 << "," << 68 + 0.5 * k << ",52\n";
  write_text(folder_ / "times.csv", points.str());
  const json j = json_of(run(track({"--points", "times.csv", "--json"})));
  EXPECT_EQ(j["point"], "");
  EXPECT_EQ(j["trackers"][0]["point_error_px"]["frames"], kFrames);
  EXPECT_LT(j["trackers"][0]["point_error_px"]["max"], 0.3);
}

TEST_F(TrackPoints, AWrongTrackIsCounted) {
  // annotated to stand still, while the picture moves by 0.5 px a frame: after 16 frames it is 8 px off
  sequence("frames", 22);
  std::ostringstream points;
  points << "frame,point,u_px,v_px\n";
  for (int k = 0; k < 22; ++k) points << k + 1 << ",still,68,52\n";
  write_text(folder_ / "still.csv", points.str());
  const json lane = json_of(run(track({"--points", "still.csv", "--json"})))["trackers"][0];
  EXPECT_NEAR(lane["point_error_px"]["max"], 10.5, 0.3);
  EXPECT_NEAR(lane["wrong_ok_frames"].get<double>(), 5, 1);
  EXPECT_EQ(lane["first_failure"]["reason"], "off");
}

TEST_F(TrackPoints, PointsThatCannotBeScoredAreRefused) {
  const std::vector<std::string> points{"--points", "points.csv"};
  const auto named = [&](const std::string& name) { return track({"--points", "points.csv", "--point", name}); };
  expect_refused(2, named("vien"), {"points.csv", "'vien'", "did you mean 'vein'", "vein, spot, far, late"});
  expect_refused(2, named("far"), {"points.csv", "'far'", "outside the region"});
  expect_refused(2, named("late"), {"points.csv", "'late'", "not visible in the first frame"});
  expect_refused(2, {"track", "frames", "--roi", "100,10,30,30", "--points", "points.csv"}, {"no point is inside"});
  expect_refused(2, track({"--point", "vein"}), {"--point", "--points"});
  expect_refused(2, {"track", "--artificial", "b", "--points", "points.csv"}, {"--points", "recorded frames"});
  expect_refused(2, {"track", scene("pig_2007"), "--points", "points.csv"}, {"--points", "recorded frames"});
  EXPECT_FALSE(fs::exists(folder_ / "runs")) << "a refused command must leave nothing behind";
}

TEST_F(TrackPoints, FilesThatCannotBeReadAreRefused) {
  const auto refused = [&](const std::string& content, const std::vector<std::string>& parts) {
    write_text(folder_ / "bad.csv", content);
    expect_refused(3, track({"--points", "bad.csv"}), parts);
    expect_refused(3, {"servo", "frames", "--roi", "50,30,40,40", "--reference", "bad.csv"}, {"bad.csv"});
  };
  expect_refused(3, track({"--points", "nowhere.csv"}), {"nowhere.csv", "cannot be read"});
  expect_refused(3, track({"--points", "."}), {"cannot be read"});
  refused("", {"bad.csv:1", "is empty"});
  refused(read_text(picture("frames", 0)), {"bad.csv:1", "expected a header with frame or time_s"});
  refused("frame,point,u_px,v_px\n1,A,60,x\n", {"bad.csv:2", "'x' under v_px is not a number"});
  refused("frame,point,u_px,v_px\n1,A,60\n", {"bad.csv:2", "3 cells under 4 columns"});
  refused("frame,point,u_px,v_px\n", {"bad.csv", "no rows"});
}

TEST_F(TrackPoints, ServoIsScoredAgainstThePoint) {
  const std::vector<std::string> servo{"servo", "frames",      "--roi",      "50,30,40,40", "--settle-s",
                                       "0",     "--reference", "points.csv", "--json"};
  const json j = json_of(run(servo));
  EXPECT_EQ(fs::path(j["residual_px"]["reference"].get<std::string>()).filename(), "points.csv");
  EXPECT_EQ(j["residual_px"]["point"], "vein");
  EXPECT_EQ(j["residual_px"]["frames"], kFrames);
  // the goal is carried with the point: it moves by half a pixel a frame
  EXPECT_NEAR(j["motion_px"]["rms"], 0.5 * std::sqrt((kFrames * kFrames - 1) / 12.0), 1e-6);
  auto named = servo;
  named.insert(named.end(), {"--point", "spot"});
  EXPECT_EQ(json_of(run(named))["residual_px"]["frames"], kFrames - 1);
  EXPECT_NEAR(json_of(run(named))["residual_px"]["max"], j["residual_px"]["max"].get<double>(), 1e-6)
      << "the points move alike, so the goal does";
  named.back() = "spto";
  expect_refused(2, named, {"did you mean 'spot'"});
}

TEST_F(TrackPoints, ASceneNamesItsPoint) {
  const std::string scene =
      "recording: {source: frames, roi: [50, 30, 40, 40], reference: points.csv, point: spot}\n"
      "engines: {estimator: assumed_depth}\n";
  write_text(folder_ / "recorded.yaml", scene);
  const json j = json_of(run({"track", "recorded.yaml", "--json", "--out", "run"}));
  EXPECT_EQ(j["trackers"][0]["point_error_px"]["name"], "spot");
  EXPECT_EQ(json_of(run({"track", "recorded.yaml", "--json", "--point", "vein"}))["point"], "vein");
  EXPECT_EQ(json_of(run({"track", "run/config.yaml", "--json"}))["point"], "spot") << "config.yaml can be run again";
  EXPECT_EQ(json_of(run({"servo", "recorded.yaml", "--json", "--quiet", "--frames", "8"}))["residual_px"]["point"],
            "spot");
  write_text(folder_ / "recorded.yaml",
             "recording: {source: frames, point: spot}\nengines: {estimator: assumed_depth}\n");
  expect_refused(2, {"servo", "recorded.yaml"}, {"recording.point", "recording.reference"});
}

}  // namespace
}  // namespace heartservo::test
