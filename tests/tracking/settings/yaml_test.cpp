#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <fstream>

#include "tests/tracking/settings/example_options.hpp"
#include "tracking/settings/errors.hpp"
#include "tracking/settings/yaml_reader.hpp"
#include "tracking/settings/yaml_writer.hpp"

namespace heartservo::test {
namespace {

ExampleOptions read(const std::string& text) {
  ExampleOptions options;
  read_fields(YAML::Load(text), "scene.yaml", options);
  return options;
}

// The message of the ConfigError that reading `text` throws.
std::string refusal(const std::string& text) {
  try {
    read(text);
  } catch (const ConfigError& e) {
    return e.what();
  }
  return "accepted";
}

TEST(YamlReader, ReadsEveryKindOfField) {
  const ExampleOptions o = read(
      "frames: 12\nnoise: false\ntitle: 2007\nrate_hz: 1e2\nengine: slow\ngains: [1, 2.5, 3]\n"
      "loop: {latency_s: 0.5, tracker: ssd, offset_m: [1, 2, 3]}\nlandmarks:\n  - x_m: 0.05\n  - name: vein\n");
  EXPECT_EQ(o.frames, 12);
  EXPECT_FALSE(o.noise);
  EXPECT_EQ(o.title, "2007");
  EXPECT_EQ(o.rate_hz, 100);
  EXPECT_EQ(o.engine, "slow");
  EXPECT_EQ(o.gains, (std::vector<double>{1, 2.5, 3}));
  EXPECT_EQ(o.loop.latency_s, 0.5);
  EXPECT_EQ(o.loop.tracker, "ssd");
  EXPECT_EQ(o.loop.offset_m, Eigen::Vector3d(1, 2, 3));
  ASSERT_EQ(o.landmarks.size(), 2u);
  EXPECT_EQ(o.landmarks[0].x_m, 0.05);
  EXPECT_EQ(o.landmarks[1].x_m, 0.001) << "an absent key keeps its default";
  EXPECT_EQ(o.landmarks[1].name, "vein");
}

TEST(YamlReader, KeepsDefaultsForAbsentAndNullKeys) {
  const ExampleOptions o = read("frames:\nloop: ~\nlandmarks:\n");
  EXPECT_EQ(o.frames, 1900);
  EXPECT_EQ(o.loop.tracker, "esm");
  EXPECT_TRUE(o.landmarks.empty());
}

TEST(YamlReader, NamesUnknownKeysWithLineAndSuggestion) {
  EXPECT_EQ(refusal("frames: 2\nrate_hx: 5\n"), "scene.yaml:2: rate_hx: unknown key (did you mean 'rate_hz'?)");
  EXPECT_EQ(refusal("loop:\n  tracker: esm\n  latensy_s: 0\n"),
            "scene.yaml:3: loop.latensy_s: unknown key (did you mean 'latency_s'?)");
  EXPECT_EQ(refusal("landmarks:\n  - x_m: 0\n  - weight: 1\n"), "scene.yaml:3: landmarks[1].weight: unknown key");
}

TEST(YamlReader, RefusesAKeyGivenTwice) {
  EXPECT_EQ(refusal("frames: 2\nframes: 3\n"), "scene.yaml:2: frames: is given twice; keep one");
  EXPECT_EQ(refusal("loop:\n  latency_s: 0\n  latency_s: 1\n"),
            "scene.yaml:3: loop.latency_s: is given twice; keep one");
}

TEST(YamlReader, RefusesWrongTypes) {
  EXPECT_EQ(refusal("frames: many"), "scene.yaml:1: frames: must be a finite number");
  EXPECT_EQ(refusal("frames: 1.5"), "scene.yaml:1: frames: must be a whole number");
  EXPECT_EQ(refusal("noise: 3"), "scene.yaml:1: noise: must be true or false");
  EXPECT_EQ(refusal("title: [a]"), "scene.yaml:1: title: must be a text");
  EXPECT_EQ(refusal("rate_hz: .nan"), "scene.yaml:1: rate_hz: must be a finite number");
  EXPECT_EQ(refusal("rate_hz: 60 fps"), "scene.yaml:1: rate_hz: must be a finite number");
  EXPECT_EQ(refusal("gains: 5"), "scene.yaml:1: gains: must be a list of numbers");
  EXPECT_EQ(refusal("loop: {offset_m: [1, 2]}"), "scene.yaml:1: loop.offset_m: must be a list of 3 numbers");
  EXPECT_EQ(refusal("loop: 5"), "scene.yaml:1: loop: must be a group of keys");
  EXPECT_EQ(refusal("landmarks: {x_m: 1}"), "scene.yaml:1: landmarks: must be a list");
  EXPECT_EQ(refusal("landmarks:\n  - 5"), "scene.yaml:2: landmarks[0]: must be a group of keys");
  EXPECT_EQ(refusal("[1, 2]"), "scene.yaml:1: must be a group of keys");
}

TEST(YamlReader, RefusesValuesOutOfRange) {
  EXPECT_EQ(refusal("frames: 0"), "scene.yaml:1: frames: 0 is out of range; must be from 1 to 1000000");
  EXPECT_EQ(refusal("rate_hz: 0.5"), "scene.yaml:1: rate_hz: 0.5 is out of range; must be at least 1 Hz");
  EXPECT_EQ(refusal("loop: {latency_s: 2}"), "scene.yaml:1: loop.latency_s: 2 is out of range; must be from 0 to 1 s");
  EXPECT_EQ(read("loop: {latency_s: 1}").loop.latency_s, 1) << "the range is inclusive";
}

TEST(YamlReader, RefusesAnUnknownChoice) {
  EXPECT_EQ(refusal("loop: {tracker: sdd}"),
            "scene.yaml:1: loop.tracker: 'sdd' is not known (did you mean 'ssd'?); choose one of esm, ssd, "
            "optical_flow");
}

TEST(YamlReader, StartsPathsAtTheGivenKey) {
  LoopOptions loop;
  try {
    read_fields(YAML::Load("lag: 1"), "scene.yaml", loop, "loop");
    FAIL() << "accepted";
  } catch (const ConfigError& e) {
    EXPECT_STREQ(e.what(), "scene.yaml:1: loop.lag: unknown key");
  }
}

TEST(YamlWriter, WritesWhatIsReadBack) {
  ExampleOptions o;
  o.frames = 7;
  o.noise = false;
  o.title = "a \"quoted\": # text\nof two lines";
  o.rate_hz = 60.1 + 0.2;
  o.gains = {1.0 / 3, -1e-300, 1e20};
  o.loop.offset_m = {0.1, 0.2, 0.3};
  o.landmarks.resize(2);
  o.landmarks[1].x_m = -0.07;
  const std::string text = to_yaml(o);
  const ExampleOptions back = read(text);
  EXPECT_EQ(back.frames, o.frames);
  EXPECT_EQ(back.noise, o.noise);
  EXPECT_EQ(back.title, o.title);
  EXPECT_EQ(back.rate_hz, o.rate_hz);
  EXPECT_EQ(back.limit_m, o.limit_m);
  EXPECT_EQ(back.engine, "");
  EXPECT_EQ(back.gains, o.gains);
  EXPECT_EQ(back.loop.offset_m, o.loop.offset_m);
  ASSERT_EQ(back.landmarks.size(), 2u);
  EXPECT_EQ(back.landmarks[1].x_m, -0.07);
  EXPECT_EQ(to_yaml(back), text);
  EXPECT_EQ(to_yaml(read(to_yaml(ExampleOptions{}))), to_yaml(ExampleOptions{})) << "empty lists too";
  EXPECT_NE(to_yaml(ExampleOptions{}).find("latency_s: 0.016\n"), std::string::npos) << "shortest numbers";
}

class YamlFile : public testing::Test {
 protected:
  std::string write(const std::string& text) {
    std::ofstream(file_) << text;
    return file_;
  }
  void TearDown() override { std::filesystem::remove(file_); }

  std::string refusal_of(const std::string& file) {
    try {
      load_yaml(file);
    } catch (const InputError& e) {
      return e.what();
    }
    return "accepted";
  }

  const std::string file_ =
      testing::TempDir() + testing::UnitTest::GetInstance()->current_test_info()->name() + ".yaml";
};

TEST_F(YamlFile, Loads) { EXPECT_EQ(load_yaml(write("a: {b: 5}"))["a"]["b"].as<int>(), 5); }

TEST_F(YamlFile, NamesTheLineOfBrokenYaml) {
  const std::string message = refusal_of(write("a: 1\nb: [1, 2\nc: 3\n"));
  EXPECT_EQ(message.find(file_ + ":3: not valid YAML: "), 0u) << message;
}

TEST_F(YamlFile, NamesAMissingFile) {
  EXPECT_EQ(refusal_of("/nowhere/scene.yaml"), "/nowhere/scene.yaml: no such file; check the path");
}

TEST_F(YamlFile, RefusesAFileWithoutKeys) {
  EXPECT_EQ(refusal_of(write("")), file_ + ": holds no keys; expected a YAML map");
  EXPECT_EQ(refusal_of(write("- 1\n- 2\n")), file_ + ": holds no keys; expected a YAML map");
}

}  // namespace
}  // namespace heartservo::test
