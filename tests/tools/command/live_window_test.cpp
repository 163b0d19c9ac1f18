// --show and --select as someone at the screen sees them: an X server without a screen, keys, clicks, screenshots.
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "tests/support/virtual_screen.hpp"
#include "tests/tools/command/command_fixture.hpp"
#include "tools/time_table.hpp"
#include "tools/window/window_view.hpp"

namespace heartservo::test {
namespace {

using tools::TimeTable;
using tools::WindowLayout;

class LiveWindowOnScreen : public CommandLine {
 protected:
  void SetUp() override {
    if (!screen_.ready()) GTEST_SKIP() << "Xvfb or xdotool is missing; ./run_tests.sh installs them";
  }

  // The window's part of the screen, once something is drawn there; the window lies in the middle or at the top left.
  cv::Mat window(cv::Size size) const {
    const cv::Mat all = screen_.picture();
    if (all.empty()) return {};
    cv::Mat lit;
    cv::inRange(all, cv::Scalar(1, 1, 1), cv::Scalar(255, 255, 255), lit);
    const cv::Rect found = cv::boundingRect(lit) & cv::Rect({0, 0}, all.size());
    if (std::abs(found.width - size.width) > 2 || std::abs(found.height - size.height) > 2) return {};
    cv::Scalar mean, spread;
    cv::meanStdDev(all(cv::Rect(found.tl(), cv::Size(400, 300))), mean, spread);
    if (spread[0] < 5) return {};  // no picture in it yet
    corner_ = found.tl();
    return all({corner_, size}).clone();
  }
  void wait_ms(int ms) const { std::this_thread::sleep_for(std::chrono::milliseconds(ms)); }
  bool same(const cv::Mat& a, const cv::Mat& b) const { return cv::norm(a, b, cv::NORM_INF) == 0; }
  void click(const WindowLayout& layout, const Eigen::Vector2d& px) const {
    const Eigen::Vector2d at = layout.to_canvas(px);
    VirtualScreen::act("mousemove " + std::to_string(corner_.x + cvRound(at.x())) + " " +
                       std::to_string(corner_.y + cvRound(at.y())) + " click 1");
    wait_ms(120);
  }
  void press(const std::string& key) const {
    VirtualScreen::act("mousemove " + std::to_string(corner_.x + 3) + " " + std::to_string(corner_.y + 3) + " key " +
                       key);
    wait_ms(200);
  }

  // How many pixels of a screenshot along the four sides have the overlay's colour of a region that is followed.
  static double share_on_sides(const cv::Mat& shot, const WindowLayout& layout, const tracking::Quad& corners) {
    int hits = 0, all = 0;
    for (std::size_t side = 0; side < 4; ++side)
      for (int k = 5; k <= 95; k += 5) {
        const Eigen::Vector2d px = corners[side] + k / 100.0 * (corners[(side + 1) % 4] - corners[side]);
        const Eigen::Vector2d at = layout.to_canvas(px);
        const cv::Vec3b c = shot.at<cv::Vec3b>(cvRound(at.y()), cvRound(at.x()));
        hits += cv::norm(cv::Vec3d(c) - cv::Vec3d(233, 180, 86)) < 40;
        ++all;
      }
    return static_cast<double>(hits) / all;
  }

  static tracking::Quad last_corners(const TimeTable& table) {
    tracking::Quad quad;
    for (std::size_t i = 0; i < 4; ++i)
      for (int axis = 0; axis < 2; ++axis)
        quad[i][axis] = table.column("track/corner" + std::to_string(i) + (axis ? "/v_px" : "/u_px")).back();
    return quad;
  }

  // Does one step after the other while the program runs; a step is done when it returns true.
  using Step = std::function<bool()>;
  Outcome played(const std::vector<std::string>& arguments, const std::vector<Step>& steps) {
    std::size_t at = 0;
    const Outcome o = run(arguments, [&](pid_t) {
      if (at < steps.size() && steps[at]()) ++at;
    });
    EXPECT_EQ(at, steps.size()) << "the run ended before this step; " << o.err;
    return o;
  }

  // Where HEARTSERVO_SCREENSHOTS names a folder, for people to look at.
  static void keep(const cv::Mat& shot, const char* name) {
    if (const char* folder = std::getenv("HEARTSERVO_SCREENSHOTS"); folder && !shot.empty())
      cv::imwrite(std::string(folder) + "/" + name + ".png", shot);
  }

  VirtualScreen screen_;
  mutable cv::Point corner_;
};

TEST_F(LiveWindowOnScreen, SpaceStopsTheFramesAndQEndsWithACompleteRun) {
  const WindowLayout layout({512, 512});
  cv::Mat paused, later, resumed;
  int rounds = 0;
  const Outcome o = played({"servo", scene("pig_2007"), "--show", "--json", "--quiet", "--out", "run"},
                           {[&] { return !window(layout.canvas()).empty(); }, [&] { return ++rounds > 60; },
                            [&] {
                              press("space");
                              paused = window(layout.canvas());
                              wait_ms(600);
                              later = window(layout.canvas());
                              press("space");
                              wait_ms(300);
                              resumed = window(layout.canvas());
                              press("space");
                              paused = window(layout.canvas());
                              press("q");
                              return true;
                            }});
  EXPECT_EQ(o.code, 130) << o.err;
  expect_complete("run");
  const auto summary = json_of(o);
  EXPECT_EQ(summary["interrupted"], true);
  keep(paused, "servo");
  ASSERT_FALSE(paused.empty() || later.empty() || resumed.empty());
  EXPECT_FALSE(same(later(layout.text()), resumed(layout.text()))) << "the frame counter goes on after the pause";
  // the last row is the frame on the screen when q was pressed
  const TimeTable table = TimeTable::read_csv(folder_ / "run/frames.csv");
  EXPECT_EQ(table.rows(), summary["frames"].get<std::size_t>());
  EXPECT_LT(table.rows(), 1900u);
  EXPECT_GT(share_on_sides(paused, layout, last_corners(table)), 0.9);
  tracking::Quad beside = last_corners(table);
  for (auto& corner : beside) corner.x() += 12;
  EXPECT_LT(share_on_sides(paused, layout, beside), 0.5);
  cv::Mat written;
  cv::inRange(paused(layout.text()), cv::Scalar(150, 100, 0), cv::Scalar(255, 255, 255), written);
  EXPECT_GT(cv::countNonZero(written), 800) << "text below the picture";
}

TEST_F(LiveWindowOnScreen, APauseStandsStill) {
  sequence("frames", 90);
  const WindowLayout layout({160, 120});
  cv::Mat paused, later;
  const Outcome o = played({"track", "frames", "--roi", "50,40,50,50", "--show", "--json", "--quiet", "--out", "run"},
                           {[&] { return !window(layout.canvas()).empty(); },
                            [&] {
                              press("space");
                              paused = window(layout.canvas());
                              wait_ms(500);
                              later = window(layout.canvas());
                              press("q");
                              return true;
                            }});
  EXPECT_EQ(o.code, 130) << o.err;
  expect_complete("run");
  keep(paused, "track");
  ASSERT_FALSE(paused.empty() || later.empty());
  EXPECT_TRUE(same(paused, later));
  EXPECT_LT(json_of(o)["frames"], 90);
  EXPECT_GT(share_on_sides(later, layout, last_corners(TimeTable::read_csv(folder_ / "run/frames.csv"))), 0.9);
}

// The waves have no corners: clicks stay where they are.
TEST_F(LiveWindowOnScreen, TheRegionIsSelectedAtTheStartAndAnewInAPause) {
  sequence("frames", 70);
  const WindowLayout layout({160, 120});
  const tracking::Quad first = tracking::rectangle(40, 30, 40, 40), second = tracking::rectangle(70, 50, 50, 44);
  cv::Mat asking;
  for (const std::string command : {"track", "servo"}) {
    const Outcome o = played({command, "frames", "--select", "--json", "--quiet", "--out", command},
                             {[&] { return !window(layout.canvas()).empty(); },
                              [&] {
                                asking = window(layout.canvas());
                                for (const auto& corner : first) click(layout, corner);
                                return true;
                              },
                              [&] {
                                press("space");
                                for (const auto& corner : second) click(layout, corner);
                                keep(window(layout.canvas()), ("select_" + command).c_str());
                                press("space");
                                return true;
                              }});
    EXPECT_EQ(o.code, 0) << command << o.err;
    expect_complete(command);
    const auto summary = json_of(o);
    ASSERT_EQ(summary["selections"].size(), 2u) << summary.dump(1);
    EXPECT_EQ(summary["frames"], 70) << "nothing was missed in the pause";
    EXPECT_EQ(summary["selections"][0]["sequence"], 0);
    for (std::size_t k = 0; k < 2; ++k) {
      const tracking::Quad& wanted = k == 0 ? first : second;
      for (std::size_t i = 0; i < 8; ++i)
        EXPECT_NEAR(summary["selections"][k]["corners_px"][i].get<double>(),
                    wanted[i / 2][static_cast<Eigen::Index>(i % 2)], 5.5)
            << command << k << i;
    }
    // from there the second region goes on with the waves, by 0.5 px a frame
    const TimeTable table = TimeTable::read_csv(folder_ / (command + "/frames.csv"));
    const double from = summary["selections"][1]["sequence"].get<double>();
    const tracking::Quad end = last_corners(table);
    EXPECT_NEAR(end[0].x() - summary["selections"][1]["corners_px"][0].get<double>(), 0.5 * (69 - from), 0.3)
        << command;
    EXPECT_NEAR(end[0].y() - summary["selections"][1]["corners_px"][1].get<double>(), 0, 0.3) << command;
    EXPECT_NE(read_text(folder_ / (command + "/report.html")).find("selected or learnt anew by hand"),
              std::string::npos);
  }
}

TEST_F(LiveWindowOnScreen, WithoutASelectionNothingIsRun) {
  sequence("frames", 5);
  const WindowLayout layout({160, 120});
  for (const std::string command : {"track", "servo"}) {
    const Outcome o = played({command, "frames", "--select", "--quiet", "--out", "run"},
                             {[&] { return !window(layout.canvas()).empty(); },
                              [&] {
                                press("q");
                                return true;
                              }});
    EXPECT_EQ(o.code, 2) << command;
    EXPECT_EQ(o.error_lines(), 1u) << o.err;
    EXPECT_NE(o.err.find("--select: the window was closed"), std::string::npos) << o.err;
    EXPECT_FALSE(fs::exists(folder_ / "run"));
  }
}

// As a window manager closes a window of ViSP, or when the X server dies.
TEST_F(LiveWindowOnScreen, ALostWindowEndsTheRunAsQDoes) {
  sequence("frames", 90);
  const WindowLayout layout({160, 120});
  const Outcome o = played({"track", "frames", "--roi", "50,40,50,50", "--show", "--json", "--quiet", "--out", "run"},
                           {[&] { return !window(layout.canvas()).empty(); },
                            [&] {
                              screen_.stop();
                              return true;
                            }});
  EXPECT_EQ(o.code, 130) << o.err;
  expect_complete("run");
  EXPECT_LT(json_of(o)["frames"], 90);
}

TEST_F(LiveWindowOnScreen, SeveralRunsHaveNoWindow) {
  expect_refused(2, {"servo", scene("pig_2007"), "--show", "--controller", "ibvs,mpc"}, {"--show", "one run"});
  ::setenv("DISPLAY", ":9999", 1);
  sequence("frames", 3);
  expect_refused(4, {"track", "frames", "--show"}, {"--show: the display ':9999' cannot be used"});
}

}  // namespace
}  // namespace heartservo::test
