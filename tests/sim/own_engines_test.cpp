// One engine of each kind, as docs/extending.md shows them, in a loop on the simulated heart; and that the page shows
// what is compiled here.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <opencv2/imgproc.hpp>

#include "servo/loop/loop.hpp"
#include "servo/loop/score.hpp"
#include "sim/scene/scene.hpp"
#include "sim/table/stages.hpp"
#include "sim/table/table.hpp"
#include "tracking/frames/frame.hpp"

namespace own {

using namespace heartservo;

// Follows a region by the best match of its first picture near where it was: shifts by whole pixels only.
class BestMatch final : public tracking::TargetTracker {
 public:
  std::string start(const tracking::Frame& frame, const tracking::Quad& corners) override {
    start_ = corners;
    shift_.setZero();
    const cv::Rect box(cv::Point(cvFloor(corners[0].x()), cvFloor(corners[0].y())),
                       cv::Point(cvCeil(corners[2].x()), cvCeil(corners[2].y())));
    if ((box & cv::Rect({}, frame.grey.size())) != box) return "the region lies outside the picture";
    frame.grey(box).copyTo(template_);
    origin_ = box.tl();
    return "";
  }

  tracking::Track track(const tracking::Frame& frame) override {
    tracking::Track track;
    track.time_s = frame.time_s;
    track.sequence = frame.sequence;
    if (frame.status == tracking::FrameStatus::OK) {
      const cv::Rect box(origin_ + cv::Point(int(shift_.x()), int(shift_.y())), template_.size());
      const cv::Rect around = (box + cv::Size(40, 40) - cv::Point(20, 20)) & cv::Rect({}, frame.grey.size());
      if (around.width > box.width && around.height > box.height) {
        cv::matchTemplate(frame.grey(around), template_, fits_, cv::TM_CCOEFF_NORMED);
        cv::Point best;
        cv::minMaxLoc(fits_, nullptr, &track.quality, nullptr, &best);
        if (track.quality > 0.7) {
          track.state = tracking::TrackState::OK;
          shift_ = {double(around.x + best.x - origin_.x), double(around.y + best.y - origin_.y)};
        }
      }
    }
    for (std::size_t i = 0; i < 4; ++i) track.corners[i] = carry(start_[i]);
    track.target = 0.25 * (track.corners[0] + track.corners[1] + track.corners[2] + track.corners[3]);
    return track;
  }

  Eigen::Vector2d carry(const Eigen::Vector2d& start_px) const override { return start_px + shift_; }
  void mark_left_out(cv::Mat&) override {}

 private:
  tracking::Quad start_;
  cv::Mat template_, fits_;
  cv::Point origin_;
  Eigen::Vector2d shift_ = Eigen::Vector2d::Zero();
};

// Goes on as between the last two samples.
class StraightOn final : public servo::MotionPredictor {
 public:
  void observe(const servo::MotionSample& sample) override {
    if (!sample.position.allFinite() || (seen_ > 0 && !(sample.time_s > now_.time_s))) return;
    before_ = now_;
    now_ = sample;
    ++seen_;
  }
  servo::Prediction predict(double time_s) const override {
    servo::Prediction p;
    p.valid = seen_ > 1;
    p.time_s = time_s;
    if (!p.valid) return p;
    p.velocity = (now_.position - before_.position) / (now_.time_s - before_.time_s);
    p.position = now_.position + p.velocity * (time_s - now_.time_s);
    p.covariance = now_.covariance;
    return p;
  }

 private:
  servo::MotionSample before_, now_;
  int seen_ = 0;
};

// Goes to where the goal will be, by a share of the way each period.
class ShareOfTheWay final : public servo::ControlLaw {
 public:
  Eigen::Vector3d velocity(const servo::ControlState& state) override {
    return 0.3 * (state.goal_then.position - state.robot.reference) / state.period_s;
  }
};

// Is at once where it is asked to be; its base stands as the camera does.
class Obedient final : public servo::ToolRobot {
 public:
  explicit Obedient(const Eigen::Vector3d& tip) : start_(tip), model_(data()) {}
  servo::ToolRobotData data() const override {
    servo::ToolRobotData d;
    d.max_speed = 0.5;
    return d;
  }
  servo::ToolState read(double time_s) override {
    model_.advance_to(time_s);
    servo::ToolState state;
    state.time_s = time_s;
    state.tip = start_ + model_.state().tip;
    return state;
  }
  void command(const servo::ToolCommand& command) override { model_.command(command); }

 private:
  Eigen::Vector3d start_;
  servo::RobotModel model_;
};

}  // namespace own

namespace heartservo {
namespace {

TEST(OwnEngines, CloseTheLoop) {
  sim::Scene scene = sim::load_scene(HEARTSERVO_SOURCE_DIR "/scenes/pig_2007.yaml");
  scene.duration_s = 1.2;
  scene.show_tool = false;
  const auto table = sim::make_table(scene);
  servo::LoopOptions options = sim::loop_options(scene, *table);
  options.tip.use_marker = false;  // the simulated tool is not the robot's

  servo::LoopStages stages = sim::make_stages(scene, *table);
  stages.target_tracker = std::make_unique<own::BestMatch>();
  stages.predictor = std::make_unique<own::StraightOn>();
  stages.control_law = std::make_unique<own::ShareOfTheWay>();
  own::Obedient robot({0, 0, 0.055});
  servo::Loop loop(table->frames(), robot, std::move(stages), options, Eigen::Vector3d::Zero(), [] { return 0.0; });
  const auto picked = table->picked();
  ASSERT_EQ(loop.start(picked.target, picked.marker), "");

  servo::LoopRecord record;
  int frames = 0, seen = 0;
  double worst_m = 0;
  while (loop.step(record)) {
    ++frames;
    seen += record.track.state == tracking::TrackState::OK;
    if (record.frame.time_s > 0.6 && record.goal_now.allFinite())
      worst_m = std::max(worst_m, (record.tip - record.goal_now).norm());
  }
  EXPECT_EQ(loop.stop_reason(), "");
  EXPECT_EQ(frames, 150);
  EXPECT_GT(seen, 140);
  EXPECT_LT(worst_m, 0.012) << "it follows";
}

std::string text_of(const std::string& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(OwnEngines, ThePageShowsWhatIsCompiledHere) {
  const std::string page = text_of(HEARTSERVO_SOURCE_DIR "/docs/extending.md"), here = text_of(__FILE__);
  int blocks = 0;
  for (auto at = page.find("```cpp\n"); at != std::string::npos; at = page.find("```cpp\n", at + 1)) {
    const auto from = at + 7, to = page.find("```", from);
    ASSERT_NE(to, std::string::npos);
    EXPECT_NE(here.find(page.substr(from, to - from)), std::string::npos) << page.substr(from, to - from);
    ++blocks;
  }
  EXPECT_EQ(blocks, 5) << "a tracker, a predictor, a law, a robot, and the loop around them";
}

}  // namespace
}  // namespace heartservo
