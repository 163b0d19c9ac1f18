#include "tools/paper/paper_tables.hpp"

#include <fmt/format.h>

#include <cmath>

#include "tools/servo_summary.hpp"

namespace heartservo::tools {

namespace {

using nlohmann::json;

constexpr const char* kAxes[] = {"x", "y", "z"};
constexpr double kLine_hz[] = {0.34, 0.67, 1.19, 2.38, 3.57, 4.76};
constexpr double kDensity[3][6] = {
    {8.7, 0, 21.8, 60, 2.8, 6.7}, {3.9, 1.9, 45.6, 33, 3.9, 11.7}, {70.9, 11.5, 5.9, 8.7, 1.2, 1.8}};
constexpr double kAcceleration[2][3] = {{1.73, 1.09, 3.33}, {1.38, 0.94, 3.67}};  // m/s^2

// The line found that is nearest to `hz`, or null where none is within 0.1 Hz.
json line_at(const json& summary, double hz) {
  json nearest;
  for (const json& line : summary["lines"]) {
    const double off = std::abs(line["frequency_hz"].get<double>() - hz);
    if (off < 0.1 && (nearest.is_null() || off < std::abs(nearest["frequency_hz"].get<double>() - hz))) nearest = line;
  }
  return nearest;
}

}  // namespace

ReportTable paper_depth(const json& entry) {
  ReportTable table{
      "Depth on a rail (section 4.1), mm",
      {"tilt, deg", "estimator", "against the laser: max", "std", "against the truth: max", "std"},
      {{"paper", "eq. 6-8", number(entry["paper_mm"]["max"], 1), number(entry["paper_mm"]["std"], 2), "", ""}},
      ""};
  const auto cell = [](const json& spread, const char* key, int decimals) {
    return spread.is_null() ? "-" : number(spread[key], decimals);
  };
  for (const json& row : entry["rows"]) {
    const json &laser = row["against_laser_mm"], &z = row["position_error_mm"]["z"];
    table.rows.push_back({row["tilt_deg"].is_string() ? row["tilt_deg"].get<std::string>() : number(row["tilt_deg"], 0),
                          row["estimator"], cell(laser, "max", 2), cell(laser, "std", 2), cell(z, "max", 3),
                          cell(z, "std", 3)});
  }
  table.note = fmt::format(
      "landmark_linear is the paper's pose, landmark_refined minimises the reprojection error, landmark_dense uses all "
      "grey levels of the plate. The laser's readings are off by up to {} mm, evenly, as the paper's were; that alone "
      "is "
      "{:.2f} mm of standard deviation. Ours differ where the plate is tilted more than theirs was: eq. 6-8 take the "
      "scale from the two columns of the homography, which noise makes unequal.",
      number(entry["laser_mm"], 1), entry["laser_mm"].get<double>() / std::sqrt(3));
  return table;
}

ReportTable paper_table_3(const std::array<json, 2>& landmarks) {
  ReportTable table{
      "Table 3: power spectral density, % of the lines",
      {"line, Hz", "paper x", "here", "here, 2nd", "paper y", "here", "here, 2nd", "paper z", "here", "here, 2nd"},
      {},
      ""};
  for (std::size_t i = 0; i < 6; ++i) {
    std::vector<std::string> row{fmt::format("{:.2f}", kLine_hz[i])};
    for (std::size_t a = 0; a < 3; ++a) {
      row.push_back(fmt::format("{:.1f}", kDensity[a][i]));
      for (const json& landmark : landmarks) {
        const json line = line_at(landmark, kLine_hz[i]);
        row.push_back(line.is_null() ? "-" : number(line["density_percent"][kAxes[a]], 1));
      }
    }
    table.rows.push_back(row);
  }
  table.note =
      "Of the tracked landmarks, 15 s. Ours differ by fractions of a percent to a few percent: the simulated heart's "
      "rate "
      "varies from beat to beat by 2 %, its sharp harmonics above 5 Hz take a share, and 15 s are only some 18 beats. "
      "The "
      "paper's columns do not add up to 100 either. The second landmark moves with the bend of the surface, too.";
  return table;
}

ReportTable paper_table_4(const std::array<json, 2>& landmarks) {
  ReportTable table{"Table 4: largest acceleration, m/s²", {"", "x", "y", "z"}, {}, ""};
  for (std::size_t i = 0; i < 2; ++i) {
    std::vector<std::string> printed{fmt::format("landmark {}, paper", i + 1)},
        here{fmt::format("landmark {}, here", i + 1)},
        truth{fmt::format("landmark {}, truth of the simulation", i + 1)};
    for (std::size_t a = 0; a < 3; ++a) {
      const json& axis = landmarks[i]["axes"][kAxes[a]];
      printed.push_back(fmt::format("{:.2f}", kAcceleration[i][a]));
      here.push_back(number(axis["max_acceleration_m_s2"], 2) + " ± " + number(axis["acceleration_sigma_m_s2"], 2));
      const json& known = landmarks[i]["truth"];
      truth.push_back(known.is_null() ? "-" : number(known["axes"][kAxes[a]]["max_acceleration_m_s2"], 2));
    }
    table.rows.insert(table.rows.end(), {printed, here, truth});
  }
  table.note =
      "Second derivative after a forward and backward low-pass, as in the paper; its cut-off is not printed, ours is "
      "chosen "
      "per axis by signal and noise. ±: standard deviation that the noise of tracking leaves. The simulated motion was "
      "made to reach the paper's 3.67 m/s² along z.";
  return table;
}

ReportTable paper_swings(const json& summary) {
  ReportTable table{"Fig. 8: displacement of the region",
                    {"tracker", "frames", "lost", "vertical, px peak to peak", "horizontal"},
                    {},
                    ""};
  for (const json& lane : summary["trackers"]) {
    const auto swing = [&](const char* axis) {
      const json& d = lane["displacement_px"][axis];
      return d.is_null() ? "-" : number(d["peak_to_peak"], 1);
    };
    table.rows.push_back(
        {lane["name"], number(summary["frames"], 0), number(lane["lost_frames"], 0), swing("y"), swing("x")});
  }
  table.note = "The paper shows the displacement of a region without a landmark (Fig. 8) and prints no numbers of it.";
  return table;
}

}  // namespace heartservo::tools
