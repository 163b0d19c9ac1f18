// The live window without a window: what keys and clicks lead to, and what is drawn.
#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "tools/window/window_state.hpp"
#include "tools/window/window_view.hpp"

namespace heartservo::tools {
namespace {

const tracking::Quad kSquare = tracking::rectangle(60.3, 40.7, 50, 50);

// A dark square on a light ground, its corners at kSquare: drawn sixteen times as large and averaged.
cv::Mat square_picture() {
  cv::Mat large(120 * 16, 160 * 16, CV_8UC1, cv::Scalar(200)), grey;
  const auto at = [](double px) { return static_cast<int>(std::lround((px + 0.5) * 16)); };
  large(cv::Range(at(kSquare[0].y()), at(kSquare[2].y())), cv::Range(at(kSquare[0].x()), at(kSquare[2].x()))) = 40;
  cv::resize(large, grey, {160, 120}, 0, 0, cv::INTER_AREA);
  return grey;
}

void click_all(WindowState& state, const tracking::Quad& corners, const cv::Mat& grey) {
  for (const auto& corner : corners) state.click(corner, grey);
}

TEST(WindowState, ClicksSnapToTheCornersOfThePicture) {
  const cv::Mat grey = square_picture();
  for (const auto& corner : kSquare)
    for (const Eigen::Vector2d& miss : {Eigen::Vector2d(2, -2), Eigen::Vector2d(-3, 1)})
      EXPECT_LT((snapped(grey, corner + miss) - corner).norm(), 0.25) << corner.transpose();
  const Eigen::Vector2d plain(85, 65), rim(1, 1);
  EXPECT_EQ(snapped(grey, plain), plain) << "there is no corner";
  EXPECT_EQ(snapped(grey, rim), rim);
}

TEST(WindowState, FourClicksInAPauseAreARegionInWhateverOrder) {
  const cv::Mat grey = square_picture();
  WindowState state;
  click_all(state, kSquare, grey);
  EXPECT_FALSE(state.take().region) << "it runs";
  state.key(" ");
  EXPECT_TRUE(state.paused());
  click_all(state, {kSquare[0], kSquare[3], kSquare[1], kSquare[2]}, grey);
  const auto asked = state.take();
  ASSERT_TRUE(asked.region);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_LT(((*asked.region)[i] - kSquare[i]).norm(), 0.25) << i;
  EXPECT_TRUE(state.paused()) << "until space is pressed again";
  EXPECT_FALSE(state.take().region) << "it is asked for once";
  state.key(" ");
  EXPECT_FALSE(state.paused());
}

TEST(WindowState, CornersWithoutARegionAreRefused) {
  const cv::Mat grey(120, 160, CV_8UC1, cv::Scalar(100));
  WindowState state;
  state.key(" ");
  for (int i = 0; i < 4; ++i) state.click({20.0 + 10 * i, 50}, grey);
  EXPECT_FALSE(state.take().region);
  EXPECT_NE(state.keys().find("no region"), std::string::npos) << state.keys();
  state.click({200, 50}, grey);
  EXPECT_TRUE(state.clicks().empty()) << "beside the picture";
  EXPECT_NE(state.keys().find("0 of 4"), std::string::npos) << state.keys();
}

TEST(WindowState, RDropsClicksFirstAndThenAsksToLearnAnew) {
  const cv::Mat grey = square_picture();
  WindowState state;
  state.key(" ");
  state.click({10, 10}, grey);
  state.key("r");
  EXPECT_TRUE(state.clicks().empty());
  EXPECT_FALSE(state.take().relearn);
  state.key("r");
  EXPECT_TRUE(state.take().relearn);
  state.key("x");
  const auto asked = state.take();
  EXPECT_FALSE(asked.relearn || asked.quit || asked.region);
  state.key("q");
  EXPECT_TRUE(state.take().quit);
}

TEST(WindowState, TheFirstSelectionGoesOnByItself) {
  const cv::Mat grey = square_picture();
  WindowState state;
  state.ask_for_region();
  state.key(" ");
  EXPECT_TRUE(state.paused()) << "there is nothing to run yet";
  click_all(state, kSquare, grey);
  EXPECT_FALSE(state.paused());
  EXPECT_TRUE(state.take().region);
}

TEST(WindowLayout, PixelsAndCanvasGoThereAndBack) {
  for (const cv::Size size : {cv::Size(160, 120), cv::Size(320, 288), cv::Size(640, 480), cv::Size(1920, 1080)}) {
    const WindowLayout layout(size);
    EXPECT_GE(layout.canvas().width, 640) << size;
    EXPECT_LE(layout.canvas().width, 1280) << size;
    EXPECT_LE(layout.canvas().height, 1060) << size;
    for (const Eigen::Vector2d& px : {Eigen::Vector2d(0, 0), Eigen::Vector2d(-0.5, -0.5), Eigen::Vector2d(12.3, 45.6)})
      EXPECT_LT((layout.to_picture(layout.to_canvas(px)) - px).norm(), 1e-9);
    const Eigen::Vector2d last = layout.to_canvas({size.width - 0.5, size.height - 0.5});
    EXPECT_NEAR(last.x(), layout.shown().width - 0.5, 1) << size;
    EXPECT_NEAR(last.y(), layout.shown().height - 0.5, 1) << size;
    EXPECT_EQ(layout.text().y, layout.shown().height);
  }
}

TEST(WindowView, DrawsRegionTrailAndText) {
  const WindowLayout layout({160, 120});
  WindowView view;
  view.picture = cv::Mat(120, 160, CV_8UC1, cv::Scalar(90));
  WindowView::Region region;
  region.track.state = tracking::TrackState::OK;
  region.track.corners = kSquare;
  WindowMarks marks;
  const cv::Mat bare = drawn(layout, view, marks);
  view.regions.push_back(region);
  const auto changed = [&](const cv::Mat& now, const Eigen::Vector2d& px) {
    const Eigen::Vector2d c = layout.to_canvas(px);
    const cv::Point at(cvRound(c.x()), cvRound(c.y()));
    return now.at<cv::Vec3b>(at) != bare.at<cv::Vec3b>(at);
  };
  const cv::Mat with_region = drawn(layout, view, marks);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_TRUE(changed(with_region, (kSquare[i] + kSquare[(i + 1) % 4]) / 2)) << i;
  EXPECT_FALSE(changed(with_region, tracking::centre(kSquare)));
  view.regions.clear();
  marks.trail = {{20, 20}, {30, 30}, {NAN, NAN}, {90, 100}};
  const cv::Mat with_trail = drawn(layout, view, marks);
  EXPECT_TRUE(changed(with_trail, {25, 25}));
  EXPECT_FALSE(changed(with_trail, {60, 65})) << "a gap stays one";
  view.lines = {"residual 0.123 mm"};
  const cv::Mat with_text = drawn(layout, view, {});
  cv::Mat difference;
  cv::absdiff(with_text(layout.text()), bare(layout.text()), difference);
  EXPECT_GT(cv::countNonZero(difference.reshape(1)), 300);
  view.picture.release();
  EXPECT_EQ(drawn(layout, view, marks).size(), layout.canvas());
}

}  // namespace
}  // namespace heartservo::tools
