#include "tools/track_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "tools/servo_summary.hpp"

namespace heartservo::tools {

using nlohmann::json;

namespace {

/// The paper's trackers: its name for them, ours, Table 5 (px), and what it says of Fig. 7.
struct Printed {
  const char *paper, *tracker;
  double mean_px, std_px;
  const char* circle;
};
constexpr Printed kPrinted[] = {{"Correlation", "correlation", 0, 0, "diverges"},
                                {"SSD", "ssd", 0.04, 0.19, "loses the pattern"},
                                {"Optical flow", "optical_flow", 0.90, 0.73, "loses the pattern"},
                                {"Composite", "composite", 0, 0, "holds"},
                                {"ESM", "esm", 0, 0, nullptr}};

// null when the run did not have that tracker
json lane_of(const json& trackers, const char* name) {
  for (const json& lane : trackers)
    if (lane["name"] == name) return lane;
  return nullptr;
}

std::string failure_text(const json& lane) {
  if (lane.is_null()) return "not run";
  const json& failure = lane["first_failure"];
  if (failure.is_null())
    return lane["error_px"].is_null() ? "holds" : fmt::format("holds, {} px mean", number(lane["error_px"]["mean"], 3));
  return fmt::format("{} in frame {}, at {} s", failure["reason"] == "lost" ? "lost" : "over 5 px off",
                     failure["sequence"].get<int>() + 1, number(failure["time_s"], 3));
}

std::string padded(const std::string& text, std::size_t width, bool right) {
  const std::size_t shown = static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
  const std::string blanks(width > shown ? width - shown : 0, ' ');
  return right ? blanks + text : text + blanks;
}

std::string wrapped(const std::string& text) {
  constexpr std::size_t kWidth = 100;
  std::string result, line;
  std::istringstream words(text);
  for (std::string word; words >> word; line += (line.empty() ? "" : " ") + word)
    if (line.size() + word.size() + 1 > kWidth) {
      result += line + "\n";
      line.clear();
    }
  return result + line + "\n";
}

bool looks_like_number(const std::string& cell) {
  return cell.empty() || cell == "-" || cell.find_first_not_of("+-.0123456789") == std::string::npos;
}

std::string why_not_the_same(double noise_grey, int speculars) {
  const std::string zeros = fmt::format(
      "Ours differ because the patch here moves by fractions of a pixel in pictures of 8 bit{}, so that no tracker "
      "reaches 0 (the paper's zeros are what two decimals show), and because ",
      noise_grey > 0 ? fmt::format(" with noise of {:g} grey levels", noise_grey) : "");
  if (speculars > 0)
    return zeros + fmt::format(
                       "{} moving speculars lie over it, which correlation, ssd and optical_flow do not leave out: how "
                       "far that throws them depends on the glare, which the paper does not state.",
                       speculars);
  return zeros +
         "ssd and optical_flow here start from a predicted place, on a pyramid: without glare that leaves ssd nothing "
         "to "
         "go wrong with, and optical_flow only the drift of chaining frames. Add --speculars 2 for the printed order.";
}

}  // namespace

ReportTable tracker_table(const json& summary) {
  const json& lanes = summary["trackers"];
  const auto some = [&](const char* key) {
    return std::any_of(lanes.begin(), lanes.end(), [&](const json& lane) { return !lane[key].is_null(); });
  };
  const bool truth = some("wrong_ok_frames"), corners = some("error_px"), point = some("point_error_px");
  const bool centre = corners && point && summary["point"] == "target";  // as well known as the corners
  ReportTable table{"Trackers", {"tracker", "lost", "uncertain", "relocks"}, {}, ""};
  const auto head = [&](std::initializer_list<const char*> names) {
    table.header.insert(table.header.end(), names.begin(), names.end());
  };
  if (truth) head({"wrong OK"});
  if (corners) head({"error px", "std", "max"});
  if (centre)
    head({"centre px"});
  else if (point)
    head({"point px", "95 %", "max", "95 % with lost"});
  const bool metric = std::any_of(lanes.begin(), lanes.end(), [](const json& l) { return l.contains("position_error_mm"); });
  if (metric) head({"x mm", "y mm", "z mm"});
  head({"ms p50", "ms p99", "x p-p px", "y p-p px"});
  for (const json& lane : lanes) {
    std::vector<std::string> row{lane["name"].get<std::string>(), number(lane["lost_frames"], 0),
                                 number(lane["uncertain_frames"], 0), number(lane["relocks"], 0)};
    const auto add = [&](const char* key, std::initializer_list<const char*> values) {
      for (const char* value : values) row.push_back(lane[key].is_null() ? "-" : number(lane[key][value], 3));
    };
    if (truth) row.push_back(number(lane["wrong_ok_frames"], 0));
    if (corners) add("error_px", {"mean", "std", "max"});
    if (centre) {
      add("point_error_px", {"mean"});
    } else if (point) {
      add("point_error_px", {"median", "p95", "max"});
      row.push_back(lane["point_error_px"].is_null() ? "-" : number(lane["point_error_px"]["with_lost"]["p95"], 3));
    }
    for (const char* axis : {"x", "y", "z"})
      if (metric)
        row.push_back(lane.contains("position_error_mm") ? number(lane["position_error_mm"][axis]["rms"], 3) : "-");
    add("ms", {"p50", "p99"});
    for (const char* axis : {"x", "y"}) {
      const json& d = lane["displacement_px"][axis];
      row.push_back(d.is_null() ? "-" : number(d["peak_to_peak"], 1));
    }
    table.rows.push_back(row);
  }
  if (corners) table.note = "Error: mean distance of the corners from the true ones, over the frames not lost.";
  if (centre) {
    table.note += " Centre: the same of the region's centre, as the tracker carries it.";
  } else if (point) {
    const std::string name = summary["point"].get<std::string>();
    table.note += fmt::format(
        "{}Point: median, 95 % and largest distance of the point{} from where it is known to be, over the frames in "
        "which it is visible and not lost; with lost: those too, at the place last believed.",
        table.note.empty() ? "" : " ", name.empty() ? "" : " " + name);
  }
  if (metric) table.note += " x, y, z: RMS error of the metric position.";
  if (truth) {
    const json& bounds = lanes[0]["wrong_over_px"];
    std::string over;
    for (const char* what : {"corners", "point"})
      if (bounds.contains(what))
        over += fmt::format("{}{} over {} px", over.empty() ? "" : ", or ", what, number(bounds[what], 0));
    table.note += fmt::format(" Wrong OK: frames called OK with the {} off.", over);
  }
  return table;
}

PaperTable paper_table_5(const json& trackers, double noise_grey, int speculars) {
  PaperTable result;
  result.table = {"Table 5 of the paper: vertical translation, error in px",
                  {"tracker", "paper mean", "paper std", "here mean", "here std"},
                  {},
                  why_not_the_same(noise_grey, speculars)};
  result.summary = {{"what", "table 5"}, {"rows", json::array()}};
  for (const auto& printed : kPrinted) {
    const json lane = lane_of(trackers, printed.tracker);
    const json ours = lane.is_null() ? json() : lane["error_px"];
    const auto here = [&](const char* key) { return ours.is_null() ? "-" : number(ours[key], 3); };
    result.table.rows.push_back({printed.paper, fmt::format("{:.2f}", printed.mean_px),
                                 fmt::format("{:.2f}", printed.std_px), here("mean"), here("std")});
    result.summary["rows"].push_back({{"tracker", printed.tracker},
                                      {"paper_px", {{"mean", printed.mean_px}, {"std", printed.std_px}}},
                                      {"here_px", ours}});
  }
  return result;
}

PaperTable paper_figure_7(const json& trackers, int speculars) {
  PaperTable result;
  result.table = {
      "Fig. 7 of the paper: circle with rotation and scale, who loses the pattern",
      {"tracker", "paper", "here"},
      {},
      speculars > 0
          ? fmt::format("With {} moving speculars. Fails: the first frame that is LOST or over 5 px off.", speculars)
          : "Fails: the first frame that is LOST or over 5 px off. Without speculars; add --speculars 16, "
            "which the paper names as one of the causes."};
  result.summary = {{"what", "figure 7"}, {"rows", json::array()}};
  for (const auto& printed : kPrinted) {
    const json lane = lane_of(trackers, printed.tracker);
    result.table.rows.push_back({printed.paper, printed.circle ? printed.circle : "not said", failure_text(lane)});
    result.summary["rows"].push_back({{"tracker", printed.tracker},
                                      {"paper", printed.circle ? json(printed.circle) : json()},
                                      {"run", !lane.is_null()},
                                      {"first_failure", lane.is_null() ? json() : lane["first_failure"]}});
  }
  return result;
}

std::string terminal_text(const ReportTable& table, bool with_note) {
  std::size_t columns = table.header.size();
  for (const auto& row : table.rows) columns = std::max(columns, row.size());
  std::vector<std::size_t> width(columns);
  std::vector<bool> numeric(columns, true);
  const auto measure = [&](const std::vector<std::string>& cells) {
    for (std::size_t i = 0; i < cells.size(); ++i) width[i] = std::max(width[i], cells[i].size());
  };
  measure(table.header);
  for (const auto& row : table.rows) {
    measure(row);
    for (std::size_t i = 0; i < row.size(); ++i) numeric[i] = numeric[i] && looks_like_number(row[i]);
  }
  std::string text;
  const auto line = [&](const std::vector<std::string>& cells) {
    std::string written;
    for (std::size_t i = 0; i < cells.size(); ++i)
      written += (i > 0 ? "  " : "") + padded(cells[i], width[i], i > 0 && numeric[i]);
    text += written.substr(0, written.find_last_not_of(' ') + 1) + "\n";
  };
  if (!table.header.empty()) line(table.header);
  for (const auto& row : table.rows) line(row);
  return with_note && !table.note.empty() ? text + "\n" + wrapped(table.note) : text;
}

}  // namespace heartservo::tools
