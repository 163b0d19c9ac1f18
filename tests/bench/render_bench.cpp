// Time of one simulated picture. A scene at 125 Hz leaves 8 ms for picture, tracking and control together.
#include <benchmark/benchmark.h>
#include <oneapi/tbb/global_control.h>

#include "sim/endoscope/endoscope.hpp"
#include "tests/sim/scene_support.hpp"

namespace heartservo::sim {
namespace {

HeartSurface surface() {
  HeartSurfaceOptions options;
  options.landmarks = {{.x_m = -0.002}, {.x_m = 0.012}};
  return HeartSurface(options, HeartMotion({}, 1, 60), 1);
}

void render(benchmark::State& state) {
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, state.range(0));
  Endoscope endoscope(test::paper_camera(), surface(), {}, 1);
  cv::Mat grey;
  std::uint64_t frame = 0;
  for (auto _ : state) {
    const double t = 0.008 * frame;
    const ToolPose tool(endoscope.surface().T_camera_landmark(0, t) * Eigen::Vector3d(0.0028, 0.0028, -0.0006));
    endoscope.render(t, frame++, grey, &tool);
    benchmark::DoNotOptimize(grey.data);
  }
}
BENCHMARK(render)->ArgName("threads")->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

void draw_tool_into_recorded_picture(benchmark::State& state) {
  tracking::Camera camera = tracking::Camera::pinhole(360, 288, 0.9);
  cv::Mat grey(288, 360, CV_8UC1, cv::Scalar(90)), colour(288, 360, CV_8UC3, cv::Scalar(60, 60, 120));
  ToolView view(camera, {});
  for (auto _ : state) draw_tool(view, Eigen::Vector3d(0.003, 0.002, 0.05), grey, &colour);
}
BENCHMARK(draw_tool_into_recorded_picture)->Unit(benchmark::kMillisecond);

void paint_texture(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(TissueTexture::procedural({}, {{}}, 1).texels());
}
BENCHMARK(paint_texture)->Unit(benchmark::kMillisecond);

void heart_motion(benchmark::State& state) {
  const HeartMotion motion({}, 1, 60);
  double t = 0;
  for (auto _ : state) benchmark::DoNotOptimize(motion.displacement(t += 0.0013));
}
BENCHMARK(heart_motion);

}  // namespace
}  // namespace heartservo::sim
