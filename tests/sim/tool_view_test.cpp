#include "sim/endoscope/tool_view.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <Eigen/Dense>
#include <functional>

#include "sim/endoscope/endoscope.hpp"
#include "sim/endoscope/painted_pattern.hpp"
#include "tests/sim/scene_support.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::sim {
namespace {

using test::paper_camera;

const Eigen::Vector3d kTip(0.003, 0.002, 0.053);

cv::Mat tool_on(int background, const tracking::Camera& camera = paper_camera(), const ToolOptions& options = {}) {
  cv::Mat grey(camera.height, camera.width, CV_8UC1, cv::Scalar(background));
  draw_tool(camera, options, kTip, grey, nullptr);
  return grey;
}

/// Shift (px) that best explains `grey` as the pattern painted on a plate, by least squares on grey, gain and bias. The
/// plate's coordinates -1..1 of a pixel come from `plate`.
Eigen::Vector2d pattern_shift(const cv::Mat& grey, std::uint32_t id, const Eigen::Vector2d& centre, int reach,
                              const std::function<Eigen::Vector2d(double, double)>& plate) {
  const auto expected = [&](double u, double v) {  // what a pixel sees: a Gaussian of half a pixel
    double sum = 0, weights = 0;
    for (int j = -4; j <= 4; ++j)
      for (int i = -4; i <= 4; ++i) {
        const Eigen::Vector2d xy = plate(u + 0.3 * i, v + 0.3 * j);
        const double w = std::exp(-(i * i + j * j) * 0.09 / (2 * 0.25));
        sum += w * painted_pattern(id, xy.x(), xy.y()), weights += w;
      }
    return sum / weights;
  };
  Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
  Eigen::Vector4d b = Eigen::Vector4d::Zero();
  for (int v = static_cast<int>(centre.y()) - reach; v <= centre.y() + reach; ++v)
    for (int u = static_cast<int>(centre.x()) - reach; u <= centre.x() + reach; ++u) {
      const double h = 0.25;
      const Eigen::Vector4d J(-(expected(u + h, v) - expected(u - h, v)) / (2 * h),
                              -(expected(u, v + h) - expected(u, v - h)) / (2 * h), expected(u, v), 1);
      A += J * J.transpose(), b += J * grey.at<std::uint8_t>(v, u);
    }
  const Eigen::Vector4d x = A.ldlt().solve(b);
  return x.head<2>() / x(2);
}

TEST(ToolView, MarkerPatternLiesWhereItsCornersProject) {
  const tracking::Camera camera = paper_camera();
  const auto corners = marker_corners({}, kTip);
  const Eigen::Vector3d middle = (corners[0] + corners[2]) / 2;
  const auto plate = [&](double u, double v) -> Eigen::Vector2d {
    const Eigen::Vector2d ray = camera.normalise({u, v});
    return (ray * middle.z() - middle.head<2>()) / ((corners[1].x() - corners[0].x()) / 2);
  };
  const Eigen::Vector2d shift = pattern_shift(tool_on(60), kMarkerPattern, camera.project(middle), 17, plate);
  EXPECT_LT(shift.norm(), 0.02) << shift.transpose();
}

TEST(ToolView, TheMarkerOfATurnedToolLiesWhereItsCornersProject) {
  const tracking::Camera camera = paper_camera();
  const ToolPose pose(kTip, Eigen::AngleAxisd(0.12, Eigen::Vector3d(1, -2, 0.7).normalized()).toRotationMatrix());
  cv::Mat grey(camera.height, camera.width, CV_8UC1, cv::Scalar(60));
  draw_tool(camera, {}, pose, grey, nullptr);
  const auto corners = marker_corners({}, pose);
  const Eigen::Vector3d middle = (corners[0] + corners[2]) / 2;
  const Eigen::Vector3d x = (corners[1] - corners[0]) / 2, y = (corners[3] - corners[0]) / 2, normal = x.cross(y);
  const auto plate = [&](double u, double v) -> Eigen::Vector2d {
    const Eigen::Vector3d ray = camera.normalise({u, v}).homogeneous();
    const Eigen::Vector3d p = ray * (normal.dot(middle) / normal.dot(ray)) - middle;
    return {p.dot(x) / x.squaredNorm(), p.dot(y) / y.squaredNorm()};
  };
  const Eigen::Vector2d shift = pattern_shift(grey, kMarkerPattern, camera.project(middle), 15, plate);
  EXPECT_LT(shift.norm(), 0.02) << shift.transpose();
}

TEST(ToolView, LandmarkPatternLiesWhereTheLandmarkProjects) {
  const tracking::Camera camera = paper_camera();
  HeartSurfaceOptions options;
  options.landmarks = {{.x_m = 0.004, .y_m = 0.003, .side_m = 0.005, .angle_rad = 0.35}};
  const HeartSurface surface(options, HeartMotion({}, 2, 10), 3);
  PictureOptions picture;
  picture.light = "flat";
  picture.noise_grey = 0;
  Endoscope endoscope(camera, surface, picture, 4);
  cv::Mat grey;
  for (const double t : {0.4, 2.9}) {
    endoscope.render(t, 0, grey);
    const Eigen::Isometry3d T = surface.T_camera_landmark(0, t);
    const auto plate = [&](double u, double v) -> Eigen::Vector2d {
      const Eigen::Vector3d ray = camera.normalise({u, v}).homogeneous();
      const double depth = T.linear().col(2).dot(T.translation()) / T.linear().col(2).dot(ray);
      return (T.inverse() * Eigen::Vector3d(depth * ray)).head<2>() / 0.0025;
    };
    const Eigen::Vector2d shift = pattern_shift(grey, 0, camera.project(T.translation()), 17, plate);
    EXPECT_LT(shift.norm(), 0.02) << shift.transpose();
  }
}

TEST(ToolView, MarkerOutlineIsSharpAndExact) {
  const tracking::Camera camera = paper_camera();
  const cv::Mat black = tool_on(0), white = tool_on(255);
  const auto corners = marker_corners({}, kTip);
  // Cover summed along a row from the free side of the left edge, three quarters down, to a pixel inside.
  const Eigen::Vector3d on_edge = corners[0] + 0.75 * (corners[3] - corners[0]);
  const Eigen::Vector2d edge = camera.project(on_edge);
  const int v = static_cast<int>(std::lround(edge.y())), inner = static_cast<int>(edge.x()) + 6;
  double cover = 0;
  for (int u = inner - 14; u <= inner; ++u)
    cover += 1 - (white.at<std::uint8_t>(v, u) - black.at<std::uint8_t>(v, u)) / 255.0;
  const Eigen::Vector2d top = camera.project(corners[0]), bottom = camera.project(corners[3]);
  const double edge_u = top.x() + (bottom.x() - top.x()) * (v - top.y()) / (bottom.y() - top.y());
  EXPECT_NEAR(inner + 0.5 - cover, edge_u, 0.06);  // the edge is bent a little by the lens
}

TEST(ToolView, MarkerCornersAreClockwiseFromTopLeftAndVisible) {
  const auto corners = marker_corners({}, kTip);
  EXPECT_LT(corners[0].x(), corners[1].x());
  EXPECT_LT(corners[1].y(), corners[2].y());
  EXPECT_GT(corners[2].x(), corners[3].x());
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(corners[i].z(), corners[0].z());
    EXPECT_NEAR((corners[(i + 1) % 4] - corners[i]).norm(), 0.004, 1e-12);
    EXPECT_TRUE(test::inside(paper_camera(), paper_camera().project(corners[i]), 5));
  }
}

TEST(ToolView, ToolEndsAtItsTip) {
  const tracking::Camera camera = paper_camera();
  const cv::Mat black = tool_on(0), white = tool_on(255);
  const auto cover = [&](const Eigen::Vector2d& p) {
    const auto u = static_cast<int>(std::lround(p.x())), v = static_cast<int>(std::lround(p.y()));
    return 1 - (white.at<std::uint8_t>(v, u) - black.at<std::uint8_t>(v, u)) / 255.0;
  };
  const Eigen::Vector3d d = ToolOptions().direction.normalized();
  EXPECT_LT(cover(camera.project(kTip)), 0.6);
  for (const double s : {0.0005, 0.001, 0.003}) EXPECT_EQ(cover(camera.project(kTip - s * d)), 0) << s;
  for (const double s : {0.001, 0.003, 0.02}) EXPECT_EQ(cover(camera.project(kTip + s * d)), 1) << s;
}

TEST(ToolView, LandmarkStaysFreeBesideAHoveringTip) {
  const tracking::Camera camera = paper_camera();
  HeartSurfaceOptions options;
  options.landmarks.resize(1);
  const HeartSurface surface(options, HeartMotion({}, 2, 10), 3);
  ToolView view(camera, {});
  for (const double t : {0.0, 0.8, 3.1}) {
    const Eigen::Isometry3d T = surface.T_camera_landmark(0, t);
    const Eigen::Vector3d tip = T * Eigen::Vector3d(0.0028, 0.0028, -0.0006);  // 4 mm from the centre
    cv::Mat black = cv::Mat::zeros(512, 512, CV_8UC1), white(512, 512, CV_8UC1, cv::Scalar(255));
    draw_tool(view, tip, black, nullptr);
    draw_tool(view, tip, white, nullptr);
    for (double q = -0.0025; q <= 0.0025; q += 2.5e-4)
      for (double p = -0.0025; p <= 0.0025; p += 2.5e-4) {
        const Eigen::Vector2d pixel = camera.project(T * Eigen::Vector3d(p, q, 0));
        const cv::Point at(cvRound(pixel.x()), cvRound(pixel.y()));
        EXPECT_EQ(white.at<std::uint8_t>(at) - black.at<std::uint8_t>(at), 255) << p << ' ' << q;
      }
  }
}

TEST(ToolView, DrawsIntoRecordedPicturesInGreyAndColour) {
  const tracking::Camera camera = tracking::Camera::pinhole(360, 288, 0.9);
  cv::Mat grey(288, 360, CV_8UC1, cv::Scalar(80)), colour(288, 360, CV_8UC3, cv::Scalar(10, 20, 200));
  draw_tool(camera, {}, kTip, grey, &colour);
  const cv::Point inside(cvRound(camera.project(marker_corners({}, kTip)[0]).x()) + 8,
                         cvRound(camera.project(marker_corners({}, kTip)[0]).y()) + 8);
  const cv::Vec3b painted = colour.at<cv::Vec3b>(inside);
  EXPECT_EQ(painted[0], grey.at<std::uint8_t>(inside));
  EXPECT_EQ(painted[2], grey.at<std::uint8_t>(inside));
  EXPECT_EQ(grey.at<std::uint8_t>(20, 20), 80);
  EXPECT_EQ(colour.at<cv::Vec3b>(20, 20), cv::Vec3b(10, 20, 200));
  EXPECT_THROW(draw_tool(paper_camera(), {}, kTip, grey, nullptr), ConfigError);
}

TEST(ToolView, RefusesAMarkerInsideTheShaftOrOverTheTip) {
  ToolOptions inside, over;
  inside.marker_offset_m.z() = 0;
  over.marker_offset_m = {0.001, 0.001, -0.01};
  EXPECT_EQ(inside.validate().size(), 1u);
  EXPECT_EQ(over.validate().size(), 1u);
  EXPECT_TRUE(ToolOptions().validate().empty());
}

}  // namespace
}  // namespace heartservo::sim
