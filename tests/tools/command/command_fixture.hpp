#pragma once
// What the tests of the command line share: the program in a folder of its own, scenes, synthetic pictures.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "tests/support/program.hpp"

namespace heartservo::test {

namespace fs = std::filesystem;

/// A number of frames that also ends in time under sanitizers.
inline std::string frames(int wanted) {
#ifdef HEARTSERVO_SANITIZED
  return std::to_string(std::max(25, wanted / 5));
#else
  return std::to_string(wanted);
#endif
}

/// Recorded data that only some machines have: environment HEARTSERVO_DATA, or ../shared/data beside the sources.
inline fs::path recorded_data() {
  const char* given = std::getenv("HEARTSERVO_DATA");
  return fs::absolute(given ? given : HEARTSERVO_SOURCE_DIR "/../shared/data");
}

class CommandLine : public testing::Test {
 protected:
  /// Runs heartservo with its own folder as the working one.
  Outcome run(std::vector<std::string> arguments, const std::function<void(pid_t)>& meanwhile = {}) const {
    arguments.insert(arguments.begin(), HEARTSERVO_PROGRAM);
    Outcome outcome = run_process(arguments, folder_.path(), meanwhile);
    EXPECT_FALSE(outcome.timed_out);
    return outcome;
  }

  /// Expects `code` and one line on stderr that holds every one of `parts`; nothing on stdout.
  void expect_refused(int code, const std::vector<std::string>& arguments,
                      const std::vector<std::string>& parts) const {
    const Outcome o = run(arguments);
    const auto command = testing::PrintToString(arguments);
    EXPECT_EQ(o.code, code) << command << "\n" << o.err;
    EXPECT_EQ(o.error_lines(), 1u) << command << "\n" << o.err;
    EXPECT_EQ(o.out, "") << command;
    for (const auto& part : parts) EXPECT_NE(o.err.find(part), std::string::npos) << command << "\n" << o.err;
    EXPECT_EQ(o.err.find("internal error"), std::string::npos) << command << "\n" << o.err;
  }

  static std::string scene(const std::string& name) {
    return std::string(HEARTSERVO_SOURCE_DIR "/scenes/") + name + ".yaml";
  }

  /// A scene of its own: pig_2007 with texts of it replaced.
  std::string edited_scene(const std::vector<std::pair<std::string, std::string>>& edits) const {
    std::string text = read_text(scene("pig_2007"));
    const auto swap = [&](const std::string& a, const std::string& b) {
      const auto at = text.find(a);
      ASSERT_NE(at, std::string::npos) << a;
      text.replace(at, a.size(), b);
    };
    swap("cameras/sauvee_2007.yaml", HEARTSERVO_SOURCE_DIR "/scenes/cameras/sauvee_2007.yaml");
    for (const auto& [from, to] : edits) swap(from, to);
    write_text(folder_ / "scene.yaml", text);
    return "scene.yaml";
  }

  /// A textured picture of smooth waves, moved by `shift` px to the right.
  static cv::Mat waves(double shift, cv::Size size = {160, 120}) {
    cv::Mat picture(size, CV_8UC1);
    for (int v = 0; v < size.height; ++v)
      for (int u = 0; u < size.width; ++u)
        picture.at<std::uint8_t>(v, u) = cv::saturate_cast<std::uint8_t>(
            128 + 50 * std::sin((u - shift) / 5.0) * std::cos(v / 6.0) + 25 * std::sin((u - shift + 1.7 * v) / 4.1));
    return picture;
  }

  /// Folder `name` with `count` pictures 00.png, 01.png, ...; the waves move by 0.5 px a frame.
  std::string sequence(const std::string& name, int count) const {
    fs::create_directories(folder_ / name);
    for (int i = 0; i < count; ++i) cv::imwrite(picture(name, i), waves(0.5 * i));
    return name;
  }
  std::string picture(const std::string& name, int index) const {
    return folder_ / (name + (index < 10 ? "/0" : "/") + std::to_string(index) + ".png");
  }

  static nlohmann::json json_of(const Outcome& o) {
    const auto json = nlohmann::json::parse(o.out, nullptr, false);  // also refuses nan and anything before or after
    EXPECT_FALSE(json.is_discarded()) << o.out << o.err;
    return json.is_discarded() ? nlohmann::json::object() : json;
  }
  nlohmann::json summary_of(const std::string& run) const {
    return nlohmann::json::parse(read_text(folder_ / (run + "/summary.json")), nullptr, false);
  }
  void expect_complete(const std::string& run) const {
    for (const char* file : {"config.yaml", "summary.json", "report.html"})
      EXPECT_GT(read_text(folder_ / (run + "/" + file)).size(), 20u) << run << "/" << file;
    EXPECT_FALSE(fs::exists(folder_ / (run + "/incomplete")));
    EXPECT_FALSE(fs::exists(folder_ / (run + ".partial")));
  }

  TemporaryFolder folder_;
};

}  // namespace heartservo::test
