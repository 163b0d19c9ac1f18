#include "tools/report/report.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "embedded.hpp"
#include "tools/report/markup.hpp"
#include "tools/report/plot_data.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tools {

namespace {

using markup::escaped;

std::string state_strip(const ReportSeries& state, std::size_t index) {
  return fmt::format(
      "<div class=\"strip\"><div class=\"legend\"><span class=\"quiet\">{0}</span><span class=\"legend\" "
      "id=\"shares{1}\"></span></div>\n<canvas id=\"strip{1}\" role=\"img\" aria-label=\"State of {0} over "
      "time\"></canvas></div>\n",
      escaped(state.label), index);
}

std::string plot_figure(const ReportPlot& plot, std::size_t index, const std::vector<ReportSeries>& states) {
  std::string html =
      fmt::format("<figure>\n<div class=\"plot-head\"><h2>{}</h2><div class=\"legend\" id=\"legend{}\"></div></div>\n",
                  escaped(plot.title), index);
  if (!plot.note.empty()) html += fmt::format("<p class=\"note\">{}</p>\n", escaped(plot.note));
  html += fmt::format(
      "<div class=\"unit\"><span>{}</span><span class=\"at\"></span><button class=\"whole\" type=\"button\">Whole "
      "run</button></div>\n<div "
      "class=\"plot\" id=\"plot{}\" role=\"img\" tabindex=\"0\" aria-label=\"{}\" "
      "aria-describedby=\"hint\"></div>\n",
      escaped(plot.y_label), index, escaped(plot.title));
  for (std::size_t i = 0; i < states.size(); ++i) html += state_strip(states[i], i);
  return html + "</figure>\n";
}

std::string first_plot(const Report& report) {
  if (report.plots.empty()) return "";
  return plot_figure(report.plots[0], 0, report.states);
}

std::string section(const char* label, const char* kind, const std::string& content) {
  if (content.empty()) return "";
  return fmt::format("<section class=\"{}\" aria-label=\"{}\">\n{}</section>\n", kind, label, content);
}

std::string other_plots(const Report& report) {
  std::string html;
  for (std::size_t i = 1; i < report.plots.size(); ++i) html += plot_figure(report.plots[i], i, {});
  const std::string hint =
      report.plots.empty()
          ? ""
          : "<p class=\"quiet hint\" id=\"hint\">Drag across a plot to zoom, shift and drag to pan, "
            "double-click for the whole run; two fingers on a touch screen. With the keyboard: arrows, "
            "+, − and 0.</p>\n";
  return hint + section("Plots over time", "plots", html);
}

std::string chart_scripts(const Report& report) {
  if (report.charts.empty()) return "";
  return fmt::format(
      "<script type=\"application/json\" id=\"charts\">{}</script>\n<script>{}</script>\n<script>{}</script>\n",
      markup::script_safe(chart_data(report.charts)), markup::without_source_map(embedded::chart_library()),
      embedded::chart_script());
}

std::string other_pictures(const Report& report) {
  std::string html;
  for (std::size_t i = 1; i < report.pictures.size(); ++i) html += markup::image(report.pictures[i]);
  if (!report.video.file.empty()) html += markup::video(report.video);
  return section("Pictures", "pictures", html);
}

std::string tables(const Report& report) {
  std::string html;
  for (const auto& table : report.tables) html += markup::table(table);
  return section("Numbers", "tables", html);
}

std::string pretty(const nlohmann::json& json) {
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string details(const Report& report) {
  std::string html;
  const auto add = [&](const char* title, const std::string& text) {
    html += fmt::format("<details><summary>{}</summary><pre>{}</pre></details>\n", title, escaped(text));
  };
  if (!report.config_yaml.empty()) add("Resolved configuration (config.yaml)", report.config_yaml);
  if (!report.summary.is_null()) add("Summary (summary.json)", pretty(report.summary));
  return html;
}

std::string made_by(const nlohmann::json& summary) {
  const bool known = summary.is_object() && summary.contains("version") && summary["version"].is_string();
  return known ? fmt::format("Made by heartservo {}.", escaped(summary["version"].get<std::string>()))
               : "Made by heartservo.";
}

}  // namespace

std::string report_html(const Report& report) {
  std::string notices;
  for (const auto& notice : report.notices)
    notices += fmt::format("<p class=\"notice\" role=\"note\">{}</p>\n", escaped(notice));
  const bool pair = !report.plots.empty() && !report.pictures.empty();
  std::string_view page = embedded::report_template();
  return markup::filled(
      page,
      {{"title", escaped(report.title)},
       {"notices", notices},
       {"number", report.headline_number.empty()
                      ? ""
                      : fmt::format("<p class=\"number\">{} <small>{}</small></p>", escaped(report.headline_number),
                                    escaped(report.headline_unit))},
       {"headline", escaped(report.headline)},
       {"first_kind", pair ? "first pair" : "first"},
       {"first_plot", first_plot(report)},
       {"first_picture", report.pictures.empty() ? "" : markup::image(report.pictures[0])},
       {"charts", section("Charts", "charts", chart_figures(report.charts))},
       {"plots", other_plots(report)},
       {"pictures", other_pictures(report)},
       {"tables", tables(report)},
       {"details", details(report)},
       {"made_by", made_by(report.summary)},
       {"credits", report.charts.empty() ? "Plots by dygraphs 2.2.1, © Dan Vanderkam and contributors, MIT licence."
                                         : "Charts by Chart.js 3, © Chart.js contributors, MIT licence."},
       {"chart_scripts", chart_scripts(report)},
       {"data", markup::script_safe(plot_data(report))},
       {"summary", report.summary.is_null()
                       ? ""
                       : fmt::format("<script type=\"application/json\" id=\"summary\">{}</script>",
                                     markup::script_safe(pretty(report.summary)))},
       {"style", std::string(embedded::report_style())},
       {"script", std::string(embedded::report_script())},
       {"dygraphs_style", markup::without_source_map(embedded::dygraphs_style())},
       {"dygraphs_script", markup::without_source_map(embedded::dygraphs_script())},
       {"dygraphs_synchronizer", markup::without_source_map(embedded::dygraphs_synchronizer())}});
}

void write_report(const Report& report, const std::filesystem::path& file) {
  const std::string html = report_html(report);
  std::ofstream out(file, std::ios::binary);
  out << html;
  out.close();
  if (!out) throw ConfigError(fmt::format("{}: cannot be written: {}", file.string(), std::strerror(errno)));
}

}  // namespace heartservo::tools
