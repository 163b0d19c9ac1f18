// Predictors, how costs grow, and memory over a long run.
#include <cstdio>

#include "servo/prediction/registry.hpp"
#include "tests/bench/speed/rows.hpp"
#include "tests/bench/speed/wave_sequence.hpp"

namespace heartservo::bench {

namespace {

// Heart and breath, 125 Hz.
servo::MotionSample sample_at(int k) {
  const double t = 0.008 * k;
  servo::MotionSample sample;
  sample.time_s = t;
  for (int axis = 0; axis < 3; ++axis)
    sample.position[axis] = 0.003 * std::sin(2 * M_PI * 1.2 * t + axis) + 0.001 * std::sin(2 * M_PI * 2.4 * t) +
                            0.004 * std::sin(2 * M_PI * 0.3 * t + axis);
  sample.covariance = 1e-10 * Eigen::Matrix3d::Identity();
  return sample;
}

// CPU time of observing one sample and foreseeing two times, median.
double predictor_s(const std::string& name, int harmonics) {
  servo::PredictorOptions options;
  options.harmonics = harmonics;
  const auto predictor = servo::predictors().make(name, options);
  std::vector<double> seconds;
  volatile double sink = 0;
  for (int k = 0; k < 6000; ++k) {
    const auto sample = sample_at(k);
    const double begin = thread_cpu_s();
    predictor->observe(sample);
    sink = predictor->predict(sample.time_s + 0.024).position.x() + predictor->predict(sample.time_s + 0.032).position.x();
    if (k > 3000) seconds.push_back(thread_cpu_s() - begin);
  }
  return quantile(seconds, 0.5);
}

// Slope of log y over log x, least squares.
double exponent(const std::vector<double>& x, const std::vector<double>& y) {
  double n = 0, a = 0, b = 0, aa = 0, ab = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double u = std::log(x[i]), v = std::log(y[i]);
    ++n, a += u, b += v, aa += u * u, ab += u * v;
  }
  return (n * ab - a * b) / (n * aa - a * a);
}

double tracker_s(std::unique_ptr<tracking::TargetTracker> tracker, double side) {
  Walk walk(std::move(tracker), side);
  for (int k = 0; k < kFrames; ++k) walk.step();
  return quantile(walk.seconds, 0.5);
}

double resident_kb() {
  long pages = 0, resident = 0;
  if (std::FILE* file = std::fopen("/proc/self/statm", "r")) {
    if (std::fscanf(file, "%ld %ld", &pages, &resident) != 2) resident = 0;
    std::fclose(file);
  }
  return 4.0 * static_cast<double>(resident);
}

void grow(Results& results, const std::string& name, const std::vector<double>& x, const std::vector<double>& seconds) {
  std::string points;
  for (std::size_t i = 0; i < x.size(); ++i) points += fmt::format("{}{:g}: {:.4f}", i ? ", " : "", x[i], 1e3 * seconds[i]);
  const double e = exponent(x, seconds);
  results.all["exponents"][name] = e;
  results.add("exponent: " + name, e, "", NAN, false, points + " ms");
}

}  // namespace

void add_scaling_rows(Results& results) {
  results.heading("predictors, one sample and two predictions");
  for (const auto& name : servo::predictors().names())
    results.add(fmt::format("predictor {}", name), 1e6 * predictor_s(name, 12), "us", NAN);

  results.heading("how costs grow");
  std::vector<double> sides{40, 60, 80, 120, 160}, points, esm, deformable;
  for (const double side : sides) {
    points.push_back(side * side);
    esm.push_back(tracker_s(tracking::trackers().make("esm", tracking::Camera{}, {}), side));
    deformable.push_back(tracker_s(tracking::trackers().make("deformable", tracking::Camera{}, {}), side));
  }
  grow(results, "esm, points of the template", points, esm);
  grow(results, "deformable, points of the template", points, deformable);
  std::vector<double> candidates{1, 2, 4, 8, 16}, composite;
  for (const double n : candidates) {
    tracking::TrackerOptions options;
    options.composite.places = static_cast<int>(n);
    composite.push_back(tracker_s(tracking::trackers().make("composite", tracking::Camera{}, options), 40));
  }
  grow(results, "composite, candidate places", candidates, composite);
  std::vector<double> harmonics{2, 4, 8, 16}, harmonic;
  for (const double n : harmonics) harmonic.push_back(predictor_s("harmonic", static_cast<int>(n)));
  grow(results, "harmonic, harmonics", harmonics, harmonic);
  std::vector<double> regions{1, 2, 4, 8}, several;
  for (const double n : regions) {
    double sum = 0;
    for (int i = 0; i < static_cast<int>(n); ++i)
      sum += tracker_s(tracking::trackers().make("esm", tracking::Camera{}, {}), 60);
    several.push_back(sum);
  }
  grow(results, "esm, regions on one core", regions, several);
}

void add_memory_rows(Results& results, int frames) {
  results.heading("memory of esm and the mixture of predictors over a long run");
  const auto& all = wave_sequence().frames;
  const auto tracker = tracking::trackers().make("esm", tracking::Camera{}, {});
  tracker->start(all[0], tracking::rectangle(236, 236, 40, 40));
  const auto predictor = servo::predictors().make("mixture", {});
  double before = 0;
  for (int k = 1; k < frames; ++k) {
    tracking::Frame frame = all[static_cast<std::size_t>(k % 198 < 100 ? k % 198 : 198 - k % 198)];
    frame.time_s = 0.008 * k;
    tracker->track(frame);
    predictor->observe(sample_at(k));
    (void)predictor->predict(frame.time_s + 0.024);
    if (k == frames / 10) before = resident_kb();
  }
  results.add("growth of the resident memory", resident_kb() - before, "kB", 64, false,
              fmt::format("from frame {} to frame {}", frames / 10, frames));
}

}  // namespace heartservo::bench
