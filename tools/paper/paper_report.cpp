#include "tools/paper/paper_report.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <array>

#include "tools/paper/paper_tables.hpp"
#include "tools/report/stored_pictures.hpp"
#include "tools/stored_run.hpp"
#include "tools/track_tables.hpp"

namespace heartservo::tools {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// Displacements of all trackers of a run, side by side: NAME/u_px, NAME/v_px.
TimeTable displacements(const StoredRun& run) {
  std::vector<std::string> names{"time_s"};
  std::vector<TimeTable> lanes;
  const json& trackers = run.summary["trackers"];
  for (const json& lane : trackers) {
    const std::string name = lane["name"];
    const fs::path csv = run.folder / (trackers.size() > 1 ? "frames_" + name + ".csv" : "frames.csv");
    lanes.push_back(TimeTable::read_csv(csv));
    names.insert(names.end(), {name + "/u_px", name + "/v_px"});
  }
  TimeTable table(names, lanes.front().rows());
  std::vector<double> row(names.size());
  for (std::size_t i = 0; i < lanes.front().rows(); ++i) {
    row[0] = lanes.front().time_s()[i];
    for (std::size_t k = 0; k < lanes.size(); ++k) {
      row[2 * k + 1] = lanes[k].column("displacement/u_px")[i];
      row[2 * k + 2] = lanes[k].column("displacement/v_px")[i];
    }
    table.append(row);
  }
  return table;
}

ReportPlot trajectory(const StoredRun& run, const TimeTable& table, const std::string& title, const char* axis) {
  ReportPlot plot{title, "px", {}, 1, "Of the region's centre since the first frame; a gap where a tracker is LOST.",
                  &table};
  for (const json& lane : run.summary["trackers"]) {
    const std::string name = lane["name"];
    plot.series.push_back({name, name + "/" + axis});
  }
  return plot;
}

// The start of the run with its region, and the trajectories (the second picture of a track run).
void add_pictures(PaperPage& page, const StoredRun& run) {
  auto pictures = read_pictures(run.folder);
  for (std::size_t i = 0; i < std::min<std::size_t>(2, pictures.size()); ++i) {
    page.report.pictures.push_back(std::move(pictures[i]));
  }
}

// What is added to the page while it lives stands under its title.
class Chapter {
 public:
  Chapter(Report& report, std::string title)
      : report_(report),
        title_(std::move(title)),
        tables_(report.tables.size()),
        plots_(report.plots.size()),
        pictures_(report.pictures.size()) {}
  ~Chapter() {
    for (std::size_t i = tables_; i < report_.tables.size(); ++i) report_.tables[i].chapter = title_;
    for (std::size_t i = plots_; i < report_.plots.size(); ++i) report_.plots[i].chapter = title_;
    for (std::size_t i = pictures_; i < report_.pictures.size(); ++i) report_.pictures[i].chapter = title_;
  }
  Chapter(const Chapter&) = delete;
  Chapter& operator=(const Chapter&) = delete;

 private:
  Report& report_;
  std::string title_;
  std::size_t tables_, plots_, pictures_;
};

int number_in(const std::string& config, const char* key) {
  const YAML::Node node = YAML::Load(config)["artificial"][key];
  return node ? node.as<int>(0) : 0;
}

void add_motion(const fs::path& runs, PaperPage& page) {
  const std::array<StoredRun, 2> analysed{read_run(runs / "motion1"), read_run(runs / "motion2")};
  const std::array<json, 2> summaries{analysed[0].summary, analysed[1].summary};
  page.report.tables.push_back(paper_table_3(summaries));
  page.report.tables.push_back(paper_table_4(summaries));
  const TimeTable& motion = page.tables.emplace_back(TimeTable::read_csv(runs / "motion1/motion.csv"));
  const TimeTable& spectrum = page.tables.emplace_back(TimeTable::read_csv(runs / "motion1/spectrum.csv"));
  const auto axes = [](const std::string& group, const std::string& unit) {
    std::vector<ReportSeries> series;
    for (const char* axis : {"x", "y", "z"}) series.push_back({axis, fmt::format("{}/{}_{}", group, axis, unit)});
    return series;
  };
  page.report.plots.push_back({"Fig. 4: the first landmark's motion, above 1 Hz", "mm", axes("beat", "m"), 1e3,
                               "Measured by tracking the 5 mm plate; camera frame.", &motion});
  page.report.plots.push_back({"Fig. 4: respiration along Z, and along X and Y", "mm", axes("respiration", "m"), 1e3,
                               "What lies below 1 Hz, about its mean; the paper has about 6 mm along Z.", &motion});
  page.report.plots.back().about_mean = true;
  ReportPlot density{"Power spectral density (Table 3)", "mm²/Hz", axes("density", "m2_hz"), 1e6, "", &spectrum};
  density.log_from = 1e-4;
  page.report.plots.push_back(density);
  page.report.plots.push_back({"Acceleration (Table 4)", "m/s²", axes("acceleration", "m_s2"), 1, "", &motion});
}

}  // namespace

void fill_paper_page(const fs::path& runs, const std::vector<Experiment>& experiments, PaperPage& page) {
  Report& report = page.report;
  ReportTable commands{
      "How each was made", {"experiment", "command"}, {}, "Each run folder has a page of its own.", true};
  for (const auto& experiment : experiments) {
    const Chapter chapter(report, experiment.title);
    commands.rows.push_back({experiment.title, command_line(experiment)});
    if (experiment.name == "sequence") {
      add_motion(runs, page);
      continue;
    }
    const StoredRun run = read_run(runs / experiment.name);
    const json& s = run.summary;
    if (experiment.name == "depth") {
      report.tables.push_back(paper_depth(s["paper"][0]));
      for (const json& row : s["paper"][0]["rows"])
        if (row["tilt_deg"].is_string() && !row["against_laser_mm"].is_null())
          report.summary["depth_std_mm"][row["estimator"].get<std::string>()] = row["against_laser_mm"]["std"];
      continue;
    }
    const TimeTable& table = page.tables.emplace_back(displacements(run));
    const int speculars = experiment.name.starts_with("figure8") ? 0 : number_in(run.config_yaml, "speculars");
    const bool five = experiment.name == "table5";
    if (five)
      report.tables.push_back(paper_table_5(s["trackers"], number_in(run.config_yaml, "noise_grey"), speculars).table);
    else if (experiment.name == "figure7")
      report.tables.push_back(paper_figure_7(s["trackers"], speculars).table);
    else
      report.tables.push_back(paper_swings(s));
    report.plots.push_back(trajectory(run, table, "Vertical displacement", "v_px"));
    if (!five) report.plots.push_back(trajectory(run, table, "Horizontal displacement", "u_px"));
    add_pictures(page, run);
  }
  report.tables.push_back(commands);
  report.title = "The paper, reproduced";
  report.headline =
      "Every table and figure of Sauvée et al., Biomedical Signal Processing and Control 2 (2007) 199–207, section 4, "
      "beside what this program gives on a simulated heart with the paper's camera and motion.";
}

}  // namespace heartservo::tools
