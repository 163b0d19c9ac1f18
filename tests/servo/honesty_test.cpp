// Ground truth is out of the stages' reach: by type, no stage can be given it; and by file, none can see it.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <type_traits>

#include "servo/loop/loop.hpp"
#include "servo/loop/score.hpp"
#include "sim/robot/cartesian_robot.hpp"
#include "sim/scene/scene.hpp"
#include "sim/table/table.hpp"

namespace heartservo::test {
namespace {

namespace fs = std::filesystem;
using servo::TruthSample;

// No value of a type that knows the truth becomes, or makes, a value that a stage takes.
template <class Value, class... Knowing>
constexpr bool closed_to = (!(std::is_convertible_v<Knowing, Value> || std::is_constructible_v<Value, Knowing> ||
                              std::is_assignable_v<Value&, Knowing> || std::is_base_of_v<Knowing, Value>)&&...);
template <class Value>
constexpr bool kClosed = closed_to<Value, TruthSample, TruthSample&, sim::Scene, sim::Scene&, sim::Table&,
                                   sim::HeartMotion, sim::HeartSurface, servo::Score>;

static_assert(kClosed<tracking::Frame> && kClosed<tracking::Track> && kClosed<tracking::TargetState>);
static_assert(kClosed<servo::MotionSample> && kClosed<servo::Prediction> && kClosed<servo::ControlState>);
static_assert(kClosed<servo::ToolState> && kClosed<servo::ToolCommand> && kClosed<servo::LoopRecord>);
static_assert(kClosed<servo::EcgSample> && kClosed<servo::EcgMonitor> && kClosed<servo::RPeak>);
static_assert(kClosed<servo::LoopOptions> && kClosed<servo::LoopStages>);
static_assert(!closed_to<TruthSample, const TruthSample&>, "the check itself can fail");

template <class Method, class Stage, class... Knowing>
constexpr bool refuses = (!std::is_invocable_v<Method, Stage&, Knowing> && ...);

static_assert(refuses<decltype(&servo::MotionPredictor::observe), servo::MotionPredictor, TruthSample, sim::Table&,
                      sim::Scene, sim::HeartMotion>);
static_assert(
    refuses<decltype(&servo::RPeakDetector::next), servo::RPeakDetector, TruthSample, sim::Table&, sim::HeartMotion>);
static_assert(refuses<decltype(&servo::ControlLaw::velocity), servo::ControlLaw, TruthSample, sim::Table&, sim::Scene>);
static_assert(refuses<decltype(&tracking::TargetTracker::track), tracking::TargetTracker, TruthSample, sim::Table&>);
static_assert(
    refuses<decltype(&tracking::TargetEstimator::estimate), tracking::TargetEstimator, TruthSample, sim::Table&>);
static_assert(
    std::is_invocable_v<decltype(&servo::MotionPredictor::observe), servo::MotionPredictor&, servo::MotionSample>,
    "the check itself can fail");

// The loop takes frames and a robot; in the place of either, nothing else of the simulator.
template <class Frames, class Robot>
constexpr bool starts = std::is_constructible_v<servo::Loop, Frames&, Robot&, servo::LoopStages, servo::LoopOptions,
                                                Eigen::Vector3d, std::function<double()>>;
static_assert(starts<tracking::FrameSource, servo::ToolRobot> && starts<tracking::FrameSource, sim::CartesianRobot>);
static_assert(!starts<sim::Table, servo::ToolRobot> && !starts<tracking::FrameSource, sim::Table>);
static_assert(!starts<TruthSample, servo::ToolRobot> && !starts<tracking::FrameSource, TruthSample>);
static_assert(!std::is_constructible_v<servo::Loop, sim::Table&> && !std::is_constructible_v<servo::Loop, TruthSample>);

// ToolRobot, all that the loop sees of a robot, does not offer the true tip.
template <class Robot>
concept TellsTheTruth = requires(const Robot& robot) {
  robot.true_tip_camera();
};
static_assert(TellsTheTruth<sim::CartesianRobot> && !TellsTheTruth<servo::ToolRobot>);

// file -> project files that it includes, all relative to the sources.
class IncludeGraph {
 public:
  IncludeGraph() {
    static const std::regex line("^\\s*#\\s*include\\s*[\"<]((tracking|servo|sim|tools|tests)/[^\">]+)[\">]");
    for (const char* floor : {"tracking", "servo", "sim", "tools"})
      for (const auto& entry : fs::recursive_directory_iterator(root() / floor)) {
        const auto extension = entry.path().extension();
        if (extension != ".hpp" && extension != ".cpp") continue;
        auto& includes = files_[fs::relative(entry.path(), root()).string()];
        std::ifstream in(entry.path());
        std::smatch match;
        for (std::string text; std::getline(in, text);)
          if (std::regex_search(text, match, line)) includes.insert(match[1]);
      }
  }

  static fs::path root() { return HEARTSERVO_SOURCE_DIR; }
  const std::map<std::string, std::set<std::string>>& files() const { return files_; }

  // Every project file visible in `file`, itself too.
  std::set<std::string> visible_in(const std::string& file) const {
    std::set<std::string> seen;
    std::vector<std::string> open{file};
    while (!open.empty()) {
      const std::string next = open.back();
      open.pop_back();
      if (!seen.insert(next).second) continue;
      const auto found = files_.find(next);
      if (found != files_.end()) open.insert(open.end(), found->second.begin(), found->second.end());
    }
    return seen;
  }

 private:
  std::map<std::string, std::set<std::string>> files_;
};

std::string floor_of(const std::string& file) { return file.substr(0, file.find('/')); }

TEST(Honesty, AFloorIncludesOnlyWhatLiesBelowIt) {
  const IncludeGraph graph;
  const std::vector<std::string> floors{"tracking", "servo", "sim", "tools"};
  const auto height = [&](const std::string& file) {
    return std::find(floors.begin(), floors.end(), floor_of(file)) - floors.begin();  // tests: above all
  };
  std::size_t includes = 0;
  for (const auto& [file, included] : graph.files())
    for (const auto& other : included) {
      ++includes;
      EXPECT_LE(height(other), height(file)) << file << " includes " << other;
      EXPECT_TRUE(graph.files().count(other) || floor_of(other) == "tests") << file << " includes " << other;
    }
  EXPECT_GT(graph.files().size(), 100u);
  EXPECT_GT(includes, 200u);
}

TEST(Honesty, NoStageSeesTheScore) {
  const IncludeGraph graph;
  const std::string truth = "servo/loop/score.hpp";
  ASSERT_TRUE(graph.files().count(truth));
  for (const auto& [file, included] : graph.files()) {
    const std::string floor = floor_of(file);
    if ((floor != "tracking" && floor != "servo") || file == truth || file == "servo/loop/score.cpp") continue;
    EXPECT_FALSE(graph.visible_in(file).count(truth)) << file << " sees TruthSample";
  }
  EXPECT_TRUE(graph.visible_in("sim/table/table.hpp").count(truth)) << "the check itself can fail";
  EXPECT_TRUE(graph.visible_in("tools/servo_command.cpp").count("sim/scene/scene.hpp")) << "the check follows includes";
}

TEST(Honesty, TheLoopAndItsStagesSeeNoSimulator) {
  const IncludeGraph graph;
  for (const char* header :
       {"servo/loop/loop.hpp", "servo/loop/loop.cpp", "servo/loop/loop_record.hpp",
        "servo/prediction/motion_predictor.hpp", "servo/control/control_law.hpp", "servo/safety/command_guard.hpp",
        "servo/robot/tool_robot.hpp", "tracking/planar/target_tracker.hpp", "tracking/landmark/target_estimator.hpp",
        "tracking/frames/frame_source.hpp"}) {
    ASSERT_TRUE(graph.files().count(header)) << header;
    for (const auto& seen : graph.visible_in(header))
      EXPECT_TRUE(floor_of(seen) == "tracking" || floor_of(seen) == "servo") << header << " sees " << seen;
  }
}

}  // namespace
}  // namespace heartservo::test
