// heartservo_prediction_goals: how well predictors foresee motions made as the reference records were, many seeds a
// class; occlusions, early beats, starts at all rates. Run by hand:
//   heartservo_prediction_goals --predictors hold,constant_velocity,mixture --seeds 100
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "servo/motion/prediction_score.hpp"
#include "servo/prediction/registry.hpp"
#include "tests/support/reference_motion.hpp"

namespace {

using namespace heartservo;
using test::ReferenceMotion;

struct Row {
  double square[2][4]{};  // sums over seeds of squared RMS: 16 and 64 ms; x, y, z, norm
  double worst_z[2]{}, max[2]{};
  int unlocks = 0, seeds = 0;
};

void add(Row& row, const servo::PredictionScore& score) {
  for (std::size_t h = 0; h < 2; ++h) {
    const auto& s = score.horizons[h];
    for (int i = 0; i < 3; ++i) row.square[h][i] += s.axis_rms_m[i] * s.axis_rms_m[i];
    row.square[h][3] += s.rms_m * s.rms_m;
    row.worst_z[h] = std::max(row.worst_z[h], s.axis_rms_m.z());
    row.max[h] = std::max(row.max[h], s.max_m);
  }
  row.unlocks += score.unlocks;
  ++row.seeds;
}

void classes(const std::vector<std::string>& names, int seeds, bool beats) {
  fmt::print("mm; RMS over all seeds, the worst seed's z RMS, and the largest distance; after 30 s of 110\n");
  fmt::print("{:<14}{:<24}| 16 ms: x, y, z, norm; worst z; max | 64 ms: the same | unlocks\n", "class", "predictor");
  struct Class {
    const char* name;
    bool sharp;
    double variability;
  };
  for (const Class& c : {Class{"six_line 2 %", false, 0.02}, Class{"six_line 5 %", false, 0.05},
                         Class{"sharp 2 %", true, 0.02}, Class{"sharp 5 %", true, 0.05}})
    for (const auto& name : names) {
      Row row;
      for (int seed = 1; seed <= seeds; ++seed) {
        ReferenceMotion motion;
        motion.sharp = c.sharp;
        motion.beat_variability = c.variability;
        motion = test::drawn(motion, 110, static_cast<std::uint64_t>(seed));
        const auto record = test::recorded(motion, 110, static_cast<std::uint64_t>(seed));
        const auto predictor = servo::predictors().make(name, servo::PredictorOptions{});
        servo::ScoreOptions options{{0.016, 0.064}, 30, {}};
        if (beats) options.r_peaks_s = motion.r_peaks_s;
        const auto score = servo::score_predictor(record, options, *predictor);
        add(row, score);
      }
      const auto mm = [&](int h, int i) { return 1e3 * std::sqrt(row.square[h][i] / row.seeds); };
      fmt::print("{:<14}{:<24}", c.name, name);
      for (int h = 0; h < 2; ++h)
        fmt::print("| {:.4f} {:.4f} {:.4f} {:.4f}; {:.4f}; {:.2f} ", mm(h, 0), mm(h, 1), mm(h, 2), mm(h, 3),
                   1e3 * row.worst_z[h], 1e3 * row.max[h]);
      fmt::print("| {}\n", row.unlocks);
      std::fflush(stdout);
    }
}

// Time from which on, in each second up to 20 s, the error at 64 ms is below a quarter (RMS) of how far the heart moves
// meanwhile.
double locked_s(const std::string& name, const ReferenceMotion& motion, std::uint64_t seed) {
  const auto record = test::recorded(motion, 20, seed);
  const auto predictor = servo::predictors().make(name, servo::PredictorOptions{});
  std::vector<double> error(200, 0), way(200, 0);  // tenths of a second
  servo::score_predictor(record, {{0.064}, 1, {}}, *predictor,
                         [&](std::size_t row, std::size_t, const servo::Prediction& p, const Eigen::Vector3d& there) {
                           if (!there.allFinite()) return;
                           const auto tenth = static_cast<std::size_t>(10 * record.time_s[row]);
                           error[tenth] += p.valid ? (p.position - there).squaredNorm() : 1;
                           way[tenth] += (record.truth[row] - there).squaredNorm();
                         });
  std::size_t locked = 0;
  for (std::size_t i = 0; i + 10 <= error.size(); ++i) {
    double off = 0, moved = 0;
    for (std::size_t k = i; k < i + 10; ++k) {
      off += error[k];
      moved += way[k];
    }
    if (off > moved / 16) locked = i + 1;
  }
  return 0.1 * static_cast<double>(locked);
}

void starts(const std::vector<std::string>& names, int seeds) {
  fmt::print("\nstart: from when on the error at 64 ms stays below a quarter of the way, s; median, worst, over 8 s\n");
  for (const auto& name : names) {
    for (const double beats : {40.0, 60.0, 75.0, 100.0, 125.0, 150.0}) {
      std::vector<double> times;
      for (const double breaths : {8.0, 12.0, 20.0, 30.0})
        for (int seed = 1; seed <= seeds; ++seed) {
          ReferenceMotion motion;
          motion.heart_rate_hz = beats / 60;
          motion.respiration_hz = breaths / 60;
          motion = test::drawn(motion, 20, static_cast<std::uint64_t>(seed));
          times.push_back(locked_s(name, motion, static_cast<std::uint64_t>(seed)));
        }
      std::sort(times.begin(), times.end());
      const auto late = std::count_if(times.begin(), times.end(), [](double t) { return t > 8; });
      fmt::print("{:<24}{:>4} beats/min: {:5.1f} {:5.1f} {:4.0f} %\n", name, beats, times[times.size() / 2],
                 times.back(), 100.0 * static_cast<double>(late) / static_cast<double>(times.size()));
      std::fflush(stdout);
    }
  }
}

void events(const std::vector<std::string>& names, int seeds) {
  fmt::print("\nocclusion of 0.5 s: RMS in it of what was foreseen 16 ms ahead, mm, over all seeds, and the worst\n");
  for (const auto& name : names) {
    double sum = 0, worst = 0;
    long n = 0;
    for (int seed = 1; seed <= seeds; ++seed) {
      const ReferenceMotion motion = test::drawn({}, 60, static_cast<std::uint64_t>(seed));
      auto record = test::recorded(motion, 45, static_cast<std::uint64_t>(seed));
      const double from = 40 + 0.1 * (seed % 9);
      for (std::size_t i = 0; i < record.time_s.size(); ++i)
        if (record.time_s[i] > from && record.time_s[i] < from + 0.5) record.measured[i].setConstant(NAN);
      const auto predictor = servo::predictors().make(name, servo::PredictorOptions{});
      double own = 0;
      long count = 0;
      servo::score_predictor(
          record, {{0.016}, 30, {}}, *predictor,
          [&](std::size_t row, std::size_t, const servo::Prediction& p, const Eigen::Vector3d& there) {
            if (!there.allFinite() || record.time_s[row] < from || record.time_s[row] > from + 0.5) return;
            own += (p.position - there).squaredNorm();
            ++count;
          });
      sum += own;
      n += count;
      worst = std::max(worst, std::sqrt(own / static_cast<double>(count)));
    }
    fmt::print("{:<24}{:.3f} {:.3f}\n", name, 1e3 * std::sqrt(sum / static_cast<double>(n)), 1e3 * worst);
    std::fflush(stdout);
  }
  fmt::print(
      "\none beat 30 % early: largest error at 16 ms in it and the two after, RMS in the beats after those, mm\n");
  for (const auto& name : names) {
    double peak = 0, worst_after = 0;
    for (int seed = 1; seed <= seeds; ++seed) {
      ReferenceMotion motion = test::drawn({}, 60, static_cast<std::uint64_t>(seed));
      auto& r = motion.r_peaks_s;
      const std::size_t early = static_cast<std::size_t>(std::upper_bound(r.begin(), r.end(), 40.0) - r.begin());
      const double shift = 0.3 * (r[early] - r[early - 1]);
      for (std::size_t i = early; i < r.size(); ++i) r[i] -= shift;
      const auto record = test::recorded(motion, 46, static_cast<std::uint64_t>(seed));
      const auto predictor = servo::predictors().make(name, servo::PredictorOptions{});
      double after = 0;
      long count = 0;
      servo::score_predictor(
          record, {{0.016}, 30, {}}, *predictor,
          [&](std::size_t row, std::size_t, const servo::Prediction& p, const Eigen::Vector3d& there) {
            const double t = record.time_s[row];
            if (!there.allFinite() || t < r[early - 1]) return;
            const double off = (p.position - there).norm();
            if (t < r[early + 2]) peak = std::max(peak, off);
            if (t < r[early + 2] || t > r[early + 4]) return;
            after += off * off;
            ++count;
          });
      worst_after = std::max(worst_after, std::sqrt(after / static_cast<double>(count)));
    }
    fmt::print("{:<24}{:.2f} {:.3f}\n", name, 1e3 * peak, 1e3 * worst_after);
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Predictors on motions made as the reference records were.");
  std::vector<std::string> names{"hold", "constant_velocity", "constant_acceleration", "autoregressive", "mixture"};
  std::string part = "all";
  int seeds = 100;
  bool beats = false;
  app.add_option("--predictors", names, "separated by commas")->delimiter(',');
  app.add_option("--seeds", seeds, "of each class")->check(CLI::Range(1, 100000));
  app.add_option("--part", part, "classes, starts, events or all");
  app.add_flag("--beats", beats, "the R peaks are known (classes)");
  CLI11_PARSE(app, argc, argv);
  if (part == "all" || part == "classes") classes(names, seeds, beats);
  if (part == "all" || part == "starts") starts(names, std::max(1, seeds / 20));
  if (part == "all" || part == "events") events(names, seeds);
}
