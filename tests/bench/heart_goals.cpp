// heartservo_heart_goals: trackers on recorded frames of a beating heart, against points that were checked by hand.
//
//   heartservo_heart_goals FRAMES POINTS.csv --regions C:212,130,50,50 B:244,114,52,46 A:252,208,52,52
//
// POINTS.csv has the columns frame (from 1), point, u_px, v_px, visible. The annotated point is carried by the
// tracker's warp. One row per tracker and region over the frames in which the point is visible:
//
//   median, p95, max   error of the point in frames that are not LOST, px
//   ok max             the largest in a frame called OK
//   OK, unc, LOST      frames
//   wrong              frames called OK with the point over 8 px off
//   ms                 median and 99th percentile of track()
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <fstream>
#include <map>
#include <sstream>

#include "servo/loop/score.hpp"
#include "tracking/frames/frame.hpp"
#include "tracking/frames/open_source.hpp"
#include "tracking/planar/registry.hpp"

namespace {

using namespace heartservo;

constexpr double kWrong_px = 8;

struct Region {
  std::string point;
  tracking::Quad corners;
};

using Points = std::map<std::pair<std::string, int>, Eigen::Vector2d>;  // visible ones, frame from 1

Points read_points(const std::string& file) {
  Points points;
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::istringstream row(line);
    std::string frame, point, u, v, visible;
    std::getline(row, frame, ','), std::getline(row, point, ','), std::getline(row, u, ',');
    std::getline(row, v, ','), std::getline(row, visible, ',');
    if (visible.substr(0, 1) == "1") points[{point, std::stoi(frame)}] = {std::stod(u), std::stod(v)};
  }
  if (points.empty()) throw std::runtime_error(file + ": no points");
  return points;
}

Region region_from(const std::string& text) {
  Region region;
  std::string number;
  std::istringstream in(text);
  std::getline(in, region.point, ':');
  std::vector<double> v;
  while (std::getline(in, number, ',')) v.push_back(std::stod(number));
  if (v.size() != 4) throw std::runtime_error(text + ": a region is POINT:x,y,w,h");
  region.corners = tracking::rectangle(v[0], v[1], v[2], v[3]);
  return region;
}

double now_ms() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void run(const std::string& name, const Region& region, const std::vector<tracking::Frame>& frames,
         const Points& points, bool verbose) {
  const auto tracker = tracking::trackers().make(name, tracking::Camera{}, tracking::TrackerOptions{});
  if (const std::string why = tracker->start(frames[0], region.corners); !why.empty()) {
    fmt::print("{:<14}{:<4} refused: {}\n", name, region.point, why);
    return;
  }
  const Eigen::Vector2d start = points.at({region.point, 1});
  std::vector<double> errors, ok_errors, ms;
  int count[3] = {0, 0, 0}, wrong = 0;
  for (std::size_t k = 1; k < frames.size(); ++k) {
    const double begin = now_ms();
    const tracking::Track track = tracker->track(frames[k]);
    ms.push_back(now_ms() - begin);
    ++count[static_cast<int>(track.state)];
    const auto truth = points.find({region.point, static_cast<int>(k) + 1});
    if (truth == points.end()) continue;
    const double error = (tracker->carry(start) - truth->second).norm();
    if (verbose)
      fmt::print(stderr, "{} {} {} {} quality {:.3f} error {:.2f}\n", name, region.point, k + 1, name_of(track.state),
                 track.quality, error);
    if (track.state == tracking::TrackState::LOST) continue;
    errors.push_back(error);
    if (track.state != tracking::TrackState::OK) continue;
    ok_errors.push_back(error);
    wrong += error > kWrong_px;
  }
  fmt::print("{:<14}{:<4}{:>8.2f}{:>8.2f}{:>8.2f}{:>8.2f}{:>6}{:>6}{:>6}{:>6}{:>8.3f}{:>8.3f}\n", name, region.point,
             servo::percentile(errors, 50), servo::percentile(errors, 95), servo::percentile(errors, 100),
             servo::percentile(ok_errors, 100), count[0], count[1], count[2], wrong, servo::percentile(ms, 50),
             servo::percentile(ms, 99));
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  std::string source, file;
  std::vector<std::string> trackers{"esm"}, regions;
  bool verbose = false;
  CLI::App app("trackers on recorded frames, against hand-checked points");
  app.add_option("frames", source)->required();
  app.add_option("points", file)->required();
  app.add_option("--regions", regions, "POINT:x,y,w,h of the first frame")->required();
  app.add_option("--trackers", trackers, "separated by commas, or 'all'")->delimiter(',')->capture_default_str();
  app.add_flag("--verbose", verbose, "a line per frame on stderr");
  CLI11_PARSE(app, argc, argv);
  try {
    if (trackers == std::vector<std::string>{"all"}) trackers = tracking::trackers().names();
    const Points points = read_points(file);
    const auto opened = tracking::open_source(source, 25);
    std::vector<tracking::Frame> frames;
    for (tracking::Frame frame; opened->next(frame);) frames.push_back(frame);
    fmt::print("{:<14}{:<4}{:>8}{:>8}{:>8}{:>8}{:>6}{:>6}{:>6}{:>6}{:>8}{:>8}\n", "tracker", "", "median", "p95", "max",
               "ok max", "OK", "unc", "LOST", "wrong", "ms p50", "ms p99");
    for (const auto& name : trackers)
      for (const auto& region : regions) run(name, region_from(region), frames, points, verbose);
  } catch (const std::exception& e) {
    fmt::print(stderr, "heartservo_heart_goals: {}\n", e.what());
    return 2;
  }
  return 0;
}
