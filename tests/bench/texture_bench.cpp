// Texture of a 40 x 40 region: building the matrices, the vector of eight, and the sliding window beside building
// afresh. `ratio` of sliding is how many times quicker a step is than a fresh build of the same windows.
#include <benchmark/benchmark.h>

#include <Eigen/LU>
#include <ctime>

#include "tests/support/analytic_image.hpp"
#include "tracking/texture/feature_bank.hpp"
#include "tracking/texture/sliding_texture.hpp"
#include "tracking/texture/texture_vector.hpp"

namespace {

using namespace heartservo;
using namespace heartservo::tracking;

constexpr int kSide = 40;

// Smooth shading with noise of 4 grey levels, as tissue under a camera has.
cv::Mat picture() {
  cv::Mat image = test::analytic_image(200, 200), noise(200, 200, CV_8UC1);
  cv::RNG random(7);
  for (int v = 0; v < image.rows; ++v)
    for (int u = 0; u < image.cols; ++u)
      image.at<std::uint8_t>(v, u) = cv::saturate_cast<std::uint8_t>(image.at<std::uint8_t>(v, u) + random.gaussian(4));
  return image;
}

TextureSettings settings_of(const benchmark::State& state) {
  TextureSettings settings;
  settings.levels = static_cast<int>(state.range(0));
  return settings;
}

GreyRegion window(const cv::Mat& image, int k) { return grey_region(image, {k % 160, (k / 160) % 160, kSide, kSide}); }

// Everything: grey values to the eight in [0, 1].
void texture_vector_of_region(benchmark::State& state) {
  const cv::Mat image = picture();
  TextureDescriber describer(settings_of(state));
  int k = 0;
  for (auto _ : state) benchmark::DoNotOptimize(describer.describe(window(image, k++)));
}
BENCHMARK(texture_vector_of_region)->Arg(16)->Arg(32)->Arg(64)->Unit(benchmark::kMicrosecond);

void build_matrices(benchmark::State& state) {
  const cv::Mat image = picture();
  const TextureSettings settings = settings_of(state);
  LevelImage levels;
  quantise(grey_region(image, {0, 0, image.cols, image.rows}), settings, levels);
  MatrixBuilder builder;
  TextureMatrices matrices;
  int k = 0;
  for (auto _ : state) {
    builder.build(levels.region(k % 160, (k / 160) % 160, kSide, kSide), 1, matrices);
    benchmark::DoNotOptimize(matrices.runs.counts.data());
    ++k;
  }
}
BENCHMARK(build_matrices)->Arg(16)->Arg(32)->Arg(64)->Unit(benchmark::kMicrosecond);

void vector_of_matrices(benchmark::State& state) {
  const cv::Mat image = picture();
  TextureDescriber describer(settings_of(state));
  describer.describe(window(image, 0));
  for (auto _ : state) benchmark::DoNotOptimize(texture_vector(describer.matrices()));
}
BENCHMARK(vector_of_matrices)->Arg(16)->Arg(32)->Unit(benchmark::kMicrosecond);

void whole_bank(benchmark::State& state) {
  const cv::Mat image = picture();
  TextureDescriber describer(settings_of(state));
  describer.describe(window(image, 0));
  for (auto _ : state) benchmark::DoNotOptimize(feature_bank(describer.matrices()));
}
BENCHMARK(whole_bank)->Arg(32)->Unit(benchmark::kMicrosecond);

void load_search_area(benchmark::State& state) {
  const cv::Mat image = picture();
  SlidingTexture sliding(settings_of(state), kSide, kSide);
  const int side = static_cast<int>(state.range(1));
  for (auto _ : state) sliding.load(grey_region(image, {0, 0, side, side}));
}
BENCHMARK(load_search_area)->Args({32, 70})->Args({32, 100})->Unit(benchmark::kMicrosecond);

void slide_one_column(benchmark::State& state) {
  const cv::Mat image = picture();
  const TextureSettings settings = settings_of(state);
  SlidingTexture sliding(settings, kSide, kSide);
  sliding.load(grey_region(image, {0, 0, image.cols, image.rows}));
  sliding.place(0, 0);
  int direction = 1;
  for (auto _ : state) {
    if (!sliding.move(direction, 0)) {
      direction = -direction;
      if (!sliding.move(0, 1)) sliding.place(0, 0);
    }
    benchmark::DoNotOptimize(sliding.matrices().runs.counts.data());
  }
  LevelImage levels;
  quantise(grey_region(image, {0, 0, image.cols, image.rows}), settings, levels);
  MatrixBuilder builder;
  TextureMatrices matrices;
  const auto cpu_s = [] {  // a busy machine does not count
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
  };
  constexpr int kSteps = 160 * 20;
  const double start = cpu_s();
  for (int k = 0; k < kSteps; ++k) {
    builder.build(levels.region(k % 160, k / 160, kSide, kSide), 1, matrices);
    benchmark::DoNotOptimize(matrices.runs.counts.data());
  }
  const double middle = cpu_s();
  sliding.place(0, 0);
  direction = 1;
  for (int k = 0; k < kSteps; ++k)
    if (!sliding.move(direction, 0)) {
      direction = -direction;
      sliding.move(0, 1);
    }
  const double end = cpu_s();
  state.counters["ratio"] = (middle - start) / (end - middle);
}
BENCHMARK(slide_one_column)->Arg(16)->Arg(32)->Unit(benchmark::kMicrosecond);

}  // namespace
