#include "tools/report/report.hpp"

#include <fmt/format.h>

#include <algorithm>
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

bool has_first_plot(const Report& report) { return !report.plots.empty() && report.plots[0].chapter.empty(); }

const ReportPicture* first_picture(const Report& report) {
  return report.pictures.empty() || !report.pictures[0].chapter.empty() ? nullptr : &report.pictures[0];
}

std::string section(const char* label, const char* kind, const std::string& content) {
  if (content.empty()) return "";
  return fmt::format("<section class=\"{}\" aria-label=\"{}\">\n{}</section>\n", kind, label, content);
}

// Of a chapter, or of none: the first of those is on the first screen.
std::string plots(const Report& report, const std::string& chapter) {
  std::string html;
  for (std::size_t i = has_first_plot(report); i < report.plots.size(); ++i)
    if (report.plots[i].chapter == chapter) html += plot_figure(report.plots[i], i, {});
  return section("Plots over time", "plots", html);
}

std::string chart_scripts(const Report& report) {
  if (report.charts.empty()) return "";
  return fmt::format(
      "<script type=\"application/json\" id=\"charts\">{}</script>\n<script>{}</script>\n<script>{}</script>\n",
      markup::script_safe(chart_data(report.charts)), markup::without_source_map(embedded::chart_library()),
      embedded::chart_script());
}

std::string pictures(const Report& report, const std::string& chapter) {
  std::string html;
  for (std::size_t i = first_picture(report) != nullptr; i < report.pictures.size(); ++i)
    if (report.pictures[i].chapter == chapter) html += markup::image(report.pictures[i]);
  if (chapter.empty() && !report.video.file.empty()) html += markup::video(report.video);
  return section("Pictures", "pictures", html);
}

std::string tables(const Report& report, const std::string& chapter) {
  std::string html;
  for (const auto& table : report.tables)
    if (table.chapter == chapter) html += markup::table(table);
  return section("Numbers", "tables", html);
}

std::string chapters(const Report& report) {
  std::vector<std::string> names;
  for (const auto& table : report.tables)
    if (!table.chapter.empty() && std::find(names.begin(), names.end(), table.chapter) == names.end())
      names.push_back(table.chapter);
  std::string links, html;
  for (std::size_t i = 0; i < names.size(); ++i) {
    links += fmt::format("<li><a href=\"#chapter{}\">{}</a></li>\n", i, escaped(names[i]));
    html +=
        fmt::format("<section class=\"chapter\" id=\"chapter{}\">\n<h2>{}</h2>\n{}{}{}</section>\n", i,
                    escaped(names[i]), tables(report, names[i]), plots(report, names[i]), pictures(report, names[i]));
  }
  return links.empty() ? "" : "<nav aria-label=\"Contents\"><ul>\n" + links + "</ul></nav>\n" + html;
}

std::string hint(const Report& report) {
  return report.plots.empty()
             ? ""
             : "<p class=\"quiet hint\" id=\"hint\">Drag across a plot to zoom, shift and drag to pan, "
               "double-click for the whole run; two fingers on a touch screen. With the keyboard: arrows, "
               "+, − and 0.</p>\n";
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
  const bool first = has_first_plot(report);
  const ReportPicture* picture = first_picture(report);
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
       {"first_kind", first && picture ? "first pair" : "first"},
       {"first_plot", first ? plot_figure(report.plots[0], 0, report.states) : ""},
       {"first_picture", picture ? markup::image(*picture) : ""},
       {"hint", hint(report)},
       {"charts", section("Charts", "charts", chart_figures(report.charts))},
       {"chapters", chapters(report)},
       {"plots", plots(report, "")},
       {"pictures", pictures(report, "")},
       {"tables", tables(report, "")},
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
