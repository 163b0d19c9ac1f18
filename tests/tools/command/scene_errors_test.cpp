// Scenes that are wrong, and the 'scene' command.
#include "tests/tools/command/command_fixture.hpp"

namespace heartservo::test {
namespace {

class SceneErrors : public CommandLine {
 protected:
  void expect_scene_refused(int code, const std::string& text, const std::vector<std::string>& parts) const {
    write_text(folder_ / "wrong.yaml", text);
    for (const char* command : {"servo", "track", "render", "scene"})
      expect_refused(code, {command, "wrong.yaml"}, parts);
  }
};

TEST_F(SceneErrors, MissingSceneIsUnreadable) {
  for (const char* command : {"servo", "track", "render", "scene"})
    expect_refused(3, {command, "nowhere.yaml"}, {"nowhere.yaml", "no such file"});
}

TEST_F(SceneErrors, BrokenYamlIsSaidWithItsLine) {
  expect_scene_refused(3, "title: a\ncamera: {frame_rate_hz: [1\nseed: }\n", {"wrong.yaml:3: "});
  expect_scene_refused(3, "", {"wrong.yaml: holds no keys"});
}

TEST_F(SceneErrors, UnknownKeyIsSaidWithLineAndNearest) {
  expect_scene_refused(2, "seed: 1\ncamera:\n  frame_rate: 25\n",
                       {"wrong.yaml:3: camera.frame_rate", "did you mean 'frame_rate_hz'"});
}

TEST_F(SceneErrors, WrongValuesAreSaidWithLineAndKey) {
  expect_scene_refused(2, "seed: 1\nsettle_s: -3\n", {"wrong.yaml:2: settle_s", "-3"});
  expect_scene_refused(2, "seed: 1\nduration_s: .nan\n", {"wrong.yaml:2: duration_s", "finite"});
  expect_scene_refused(2, "engines:\n  tracker: esn\n", {"wrong.yaml:2: engines.tracker", "did you mean 'esm'"});
  expect_scene_refused(2, "loop:\n  offset_m: [1, 2]\n", {"wrong.yaml:2: loop.offset_m", "list of 3"});
}

TEST_F(SceneErrors, AllProblemsBetweenKeysAreSaidAtOnce) {
  expect_scene_refused(2, "duration_s: 1\nsettle_s: 2\nrecording: {roi: [1, 2, 3]}\ntarget: {landmark: 7}\n",
                       {"settle_s (2 s)", "target.landmark is 7", "recording.roi"});
  expect_scene_refused(2, "recording: {source: x, roi: [1, 2, 0, 20]}\nengines: {estimator: assumed_depth}\n",
                       {"recording.roi needs a width and a height"});
}

TEST_F(SceneErrors, MissingCalibrationIsUnreadable) {
  expect_scene_refused(3, "camera: {calibration: none.yaml}\nsurface: {landmarks: [{side_m: 0.005}]}\n", {"none.yaml"});
}

TEST_F(SceneErrors, ShippedScenesAreGood) {
  int count = 0;
  for (const auto& entry : fs::directory_iterator(HEARTSERVO_SOURCE_DIR "/scenes")) {
    if (entry.path().extension() != ".yaml") continue;
    ++count;
    const Outcome o = run({"scene", entry.path()});
    EXPECT_EQ(o.code, 0) << o.err;
    EXPECT_NE(o.out.find(entry.path().filename()), std::string::npos) << o.out;
    EXPECT_EQ(read_text(entry.path()).rfind("# yaml-language-server: $schema=scene.schema.json\n", 0), 0u)
        << entry.path() << " must name its schema in the first line";
  }
  EXPECT_GE(count, 3);
}

TEST_F(SceneErrors, DocumentsAreWhatTheProgramMakesNow) {
  for (const auto& [kind, file] : {std::pair{"markdown", "scenes/README.md"}, {"schema", "scenes/scene.schema.json"}}) {
    const Outcome o = run({"scene", "--keys", kind});
    EXPECT_EQ(o.code, 0) << o.err;
    EXPECT_GT(o.out.size(), 5000u);
    EXPECT_TRUE(read_text(std::string(HEARTSERVO_SOURCE_DIR "/") + file) == o.out)
        << file << " is not what the program makes now; run\n  heartservo scene --keys " << kind << " > " << file;
  }
}

TEST_F(SceneErrors, EveryShippedKeyIsInTheSchema) {
  const auto schema = json_of(run({"scene", "--keys", "schema"}));
  for (const char* key : {"title", "seed", "camera", "surface", "engines", "loop"})
    EXPECT_TRUE(schema["properties"].contains(key)) << key;
  EXPECT_TRUE(schema["properties"]["surface"]["properties"]["landmarks"]["items"]["properties"].contains("side_m"));
}

}  // namespace
}  // namespace heartservo::test
