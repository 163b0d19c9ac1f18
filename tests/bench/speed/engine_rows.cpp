// Texture, composite, deformable and the landmark's dense pose.
#include "sim/sequence/artificial_sequence.hpp"
#include "tests/bench/speed/rows.hpp"
#include "tests/bench/speed/wave_sequence.hpp"
#include "tests/sim/posed_landmark.hpp"
#include "tests/support/table2_camera.hpp"
#include "tests/tracking/landmark/square_scene.hpp"
#include "tracking/landmark/dense_estimator.hpp"
#include "tracking/planar/deformable_aligner.hpp"
#include "tracking/planar/planar_tracker.hpp"
#include "tracking/texture/sliding_texture.hpp"
#include "tracking/texture/texture_vector.hpp"

namespace heartservo::bench {

namespace {

constexpr int kTexture = 40;  // px, side of the region

template <class Work>
double median_s(int times, const Work& work) {
  std::vector<double> seconds;
  for (int k = 0; k < times; ++k) {
    const double begin = thread_cpu_s();
    work(k);
    seconds.push_back(thread_cpu_s() - begin);
  }
  return quantile(seconds, 0.5);
}

}  // namespace

void add_texture_rows(Results& results) {
  results.heading("texture, 40 x 40, 32 grey levels");
  const cv::Mat image = wave_sequence().frames[0].grey(cv::Rect(100, 100, 200, 200)).clone();
  tracking::TextureSettings settings;
  settings.levels = 32;
  tracking::TextureDescriber describer(settings);
  volatile double sink = 0;
  const double vector_s = median_s(2000, [&](int k) {
    sink = describer.describe(tracking::grey_region(image, {k % 160, k / 160 % 160, kTexture, kTexture}))[0];
  });
  results.add("texture vector, all eight features", 1e6 * vector_s, "us", 30);

  tracking::LevelImage levels;
  quantise(tracking::grey_region(image, {0, 0, image.cols, image.rows}), settings, levels);
  tracking::MatrixBuilder builder;
  tracking::TextureMatrices matrices;
  constexpr int kSteps = 160 * 20;
  const double begin = thread_cpu_s();
  for (int k = 0; k < kSteps; ++k) builder.build(levels.region(k % 160, k / 160, kTexture, kTexture), 1, matrices);
  const double middle = thread_cpu_s();
  tracking::SlidingTexture sliding(settings, kTexture, kTexture);
  sliding.load(tracking::grey_region(image, {0, 0, image.cols, image.rows}));
  sliding.place(0, 0);
  int direction = 1;
  const double start = thread_cpu_s();
  for (int k = 0; k < kSteps; ++k)
    if (!sliding.move(direction, 0)) direction = -direction, sliding.move(0, 1);
  results.add("incremental matrices over building them anew", (middle - begin) / (thread_cpu_s() - start), "x", 6, true);
}

void add_composite_rows(Results& results) {
  results.heading("composite, 40 x 40, whole update");
  // foreseen, then with leaps of up to 20 px that make it search, then covered for a while: lost
  const auto& frames = wave_sequence().frames;
  const tracking::Quad region = tracking::rectangle(236, 236, 40, 40);
  for (const std::string kind : {"foreseen", "leaps", "lost"}) {
    const auto tracker = tracking::trackers().make("composite", tracking::Camera{}, {});
    tracker->start(frames[0], region);
    std::vector<double> seconds;
    int lost = 0;
    for (int k = 1; k < 400; ++k) {
      tracking::Frame frame = frames[static_cast<std::size_t>(k % 198 < 100 ? k % 198 : 198 - k % 198)];
      frame.time_s = 0.008 * k;
      if (kind == "leaps" && k % 4 >= 2) {  // there and back, of changing length and direction
        const double angle = 2.4 * (k / 4);
        const cv::Matx23d shift(1, 0, std::round(20 * std::cos(angle)), 0, 1, std::round(20 * std::sin(angle)));
        cv::Mat moved;
        cv::warpAffine(frame.grey, moved, shift, frame.grey.size(), cv::INTER_NEAREST, cv::BORDER_REFLECT_101);
        frame.grey = moved;
      } else if (kind == "lost" && k % 100 >= 50) {
        frame.grey = frame.grey.clone();
        cv::circle(frame.grey, {256, 290}, 110, cv::Scalar(60), cv::FILLED);
      }
      const double begin = cpu_s();
      const auto track = tracker->track(frame);
      seconds.push_back(cpu_s() - begin);
      lost += track.state == tracking::TrackState::LOST;
    }
    results.add(fmt::format("composite, {}: p99", kind), 1e3 * quantile(seconds, 0.99), "ms", 2.5, false,
                fmt::format("median {:.3f} ms, frames lost {}", 1e3 * quantile(seconds, 0.5), lost));
  }
}

void add_deformable_rows(Results& results) {
  results.heading("deformable");
  const auto row = [&](const std::string& name, const tracking::DeformableOptions& options, double side, double goal) {
    Walk walk(std::make_unique<tracking::PlanarTracker>(tracking::make_deformable_aligner(options), tracking::Camera{},
                                                        tracking::TrackerOptions{}),
              side);
    for (int k = 0; k < kFrames; ++k) walk.step();
    results.add(name, 1e3 * quantile(walk.seconds, 0.5), "ms", goal, false,
                fmt::format("median; error {:.4f} px, p99 {:.3f} ms", walk.mean_error_px(),
                            1e3 * quantile(walk.seconds, 0.99)));
  };
  tracking::DeformableOptions coarse;
  coarse.cell_px = 27;  // three cells: 5 x 5 control points
  row("deformable 80 x 80, 5 x 5 control points", coarse, 80, 1.5);
  row("deformable 80 x 80, 8 x 8 control points (default)", {}, 80, NAN);
  row("deformable 240 x 240, 8 x 8 control points", {}, 240, NAN);
  row("deformable 390 x 390, as in scenes/texture_only.yaml", {}, 390, 8);
}

void add_pose_rows(Results& results) {
  results.heading("dense pose of a plate of 54 x 54 px, grey noise 3");
  std::mt19937_64 random(1);
  const tracking::Camera camera = test::table2_camera();
  const test::PosedLandmark landmark(camera);
  tracking::DenseEstimator estimator(camera, test::PosedLandmark::kSide_m, sim::pattern_picture(0), 0.1);
  const double depth = camera.fx * test::PosedLandmark::kSide_m / 54;
  std::vector<double> seconds, errors;
  int invalid = 0;
  for (int k = 0; k < 40; ++k) {
    const Eigen::Isometry3d truth = test::tilted_pose(random, test::uniform(random, 0, 0.5), depth);
    tracking::Frame frame;
    frame.grey = landmark.picture(truth, 3, random());
    tracking::Track track;
    track.state = tracking::TrackState::OK;
    for (int again = 0; again < 4; ++again) {  // at first rays and memory are new
      frame.sequence = static_cast<std::uint64_t>(10 * k + again);
      frame.time_s = 10 * k + again;
      track.time_s = frame.time_s, track.sequence = frame.sequence;
      track.corners = test::with_noise(
          random, tracking::project_square(camera, truth, test::PosedLandmark::kSide_m), 0.1);
      const double begin = cpu_s();
      estimator.look_at(frame);
      const auto state = estimator.estimate(track);
      if (again > 0) seconds.push_back(cpu_s() - begin);
      invalid += !estimator.last_dense().valid;
      errors.push_back(std::abs(state.T_camera_target.translation().z() - truth.translation().z()));
    }
  }
  results.add("dense pose 54 x 54", 1e3 * quantile(seconds, 0.5), "ms", 0.3, false,
              fmt::format("median, corners' pose included; p99 {:.3f} ms, |z error| {:.4f} mm, not valid {}",
                          1e3 * quantile(seconds, 0.99), 1e3 * quantile(errors, 0.5), invalid));
}

}  // namespace heartservo::bench
