#include "tools/depth_rail.hpp"

#include <fmt/format.h>

#include <numbers>

#include "tools/interrupt.hpp"
#include "tools/progress.hpp"
#include "tools/report/report.hpp"
#include "tools/run_folder.hpp"

namespace heartservo::tools {

using nlohmann::json;

namespace {

constexpr double kPaperMax_mm = 0.8, kPaperStd_mm = 0.34;

json spread_json(const servo::Spread& s) {
  if (s.count == 0) return nullptr;
  return {{"mean", 1e3 * s.mean}, {"std", 1e3 * s.std}, {"max", 1e3 * s.max}};
}

std::string mm(const servo::Spread& s, double value, int digits) {
  return s.count == 0 ? "-" : fmt::format("{:.{}f}", 1e3 * value, digits);
}

}  // namespace

PaperTable depth_rail_table(const std::vector<sim::DepthRailRow>& rows, double laser_m) {
  PaperTable result;
  result.table.title = "Depth on a rail (section 4.1), mm";
  result.table.header = {"tilt, deg",    "estimator", "frames", "lost",   "z - laser max", "z - laser std", "z max",
                          "z mean error", "z std",     "x std",  "y std"};
  const std::string paper[] = {"paper", "eq. 6-8", "", "", fmt::format("{}", kPaperMax_mm),
                               fmt::format("{}", kPaperStd_mm), "", "", "", "", ""};
  result.table.rows.emplace_back(std::begin(paper), std::end(paper));
  result.summary = {{"what", "section 4.1"},
                    {"paper_mm", {{"max", kPaperMax_mm}, {"std", kPaperStd_mm}}},
                    {"laser_mm", 1e3 * laser_m},
                    {"rows", json::array()}};
  for (const auto& r : rows) {
    const double tilt_deg = r.tilt_rad * 180 / std::numbers::pi;
    result.table.rows.push_back({r.all_tilts ? "all" : fmt::format("{:.0f}", tilt_deg), r.estimator,
                                 std::to_string(r.frames), std::to_string(r.lost),
                                 mm(r.against_laser, r.against_laser.max, 2), mm(r.against_laser, r.against_laser.std, 2),
                                 mm(r.z, r.z.max, 3), mm(r.z, r.z.mean, 4), mm(r.z, r.z.std, 4), mm(r.x, r.x.std, 4),
                                 mm(r.y, r.y.std, 4)});
    json row{{"estimator", r.estimator}, {"frames", r.frames}, {"lost_frames", r.lost}};
    row["tilt_deg"] = r.all_tilts ? json("all") : json(tilt_deg);
    row["against_laser_mm"] = spread_json(r.against_laser);
    row["position_error_mm"] = {{"x", spread_json(r.x)}, {"y", spread_json(r.y)}, {"z", spread_json(r.z)}};
    result.summary["rows"].push_back(row);
  }
  result.table.note = fmt::format(
      "z - laser: against a simulated laser whose readings are off by up to {} mm, as in the paper, evenly; its own "
      "standard deviation is {:.2f} mm. The other columns: against the truth. max: largest absolute error.",
      1e3 * laser_m, 1e3 * laser_m / std::sqrt(3));
  return result;
}

int run_depth_rail(const RunOptions& o, const sim::Scene& scene) {
  RunFolder folder(run_path(o, "track"));
  const std::size_t per_tilt =
      scene.max_frames > 0 ? std::min(scene.max_frames, scene.frame_count()) : scene.frame_count();
  std::size_t count = 0;
  bool interrupted = false;
  std::vector<sim::DepthRailRow> rows;
  {
    const Interrupt interrupt;
    Progress progress("track " + stem_of(o.source), per_tilt * scene.depth_rail.tilts_rad.size(), o.quiet);
    rows = sim::run_depth_rail(scene, [&](std::size_t done) {
      progress.update(count = done);
      return !(interrupted = interrupt.requested());
    });
  }
  const PaperTable paper = depth_rail_table(rows, scene.depth_rail.laser_m);
  const auto& dense = rows.back();
  Report report;
  report.title = "track " + stem_of(o.source);
  report.headline = fmt::format("Standard deviation of depth by {} against the truth, all tilts; the paper's linear pose "
                                "had {} mm against its laser.",
                                dense.estimator, kPaperStd_mm);
  report.headline_number = mm(dense.z, dense.z.std, 3);
  report.headline_unit = "mm";
  report.tables = {paper.table};
  report.config_yaml = config_text(scene, "track");
  report.summary = {{"command", "track"}, {"version", HEARTSERVO_VERSION}, {"source", o.source},
                    {"frames", count},    {"interrupted", interrupted},    {"seed", scene.seed},
                    {"tracker", scene.engines.tracker}, {"paper", json::array({paper.summary})}};
  finish_run(folder, report, o,
             fmt::format("{}: {} frames\n\n{}", o.source, count, terminal_text(paper.table, true)));
  return interrupted ? INTERRUPTED : DONE;
}

}  // namespace heartservo::tools
