#pragma once
// A report such as a servo run writes: a heart that moves 11 mm peak to peak in z, a tip that follows it to 0.4 mm.
#include <cmath>
#include <limits>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <random>

#include "tools/report/report.hpp"

namespace heartservo::test {

inline tools::TimeTable synthetic_table(std::size_t rows) {
  constexpr double RATE_HZ = 60;
  const auto none = std::numeric_limits<double>::quiet_NaN();
  tools::TimeTable table(
      {"time_s", "heart/x_m", "heart/y_m", "heart/z_m", "residual/x_m", "residual/y_m", "residual/z_m",
       "residual/norm_m", "tip/z_m", "tracking/error_px", "tracking/quality", "tracking/state"},
      rows);
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise(0, 1);
  for (std::size_t i = 0; i < rows; ++i) {
    const double t = static_cast<double>(i) / RATE_HZ, w = 2 * std::numbers::pi;
    const double breath = std::pow(std::max(0.0, std::sin(w * 0.3 * t)), 2);
    const double beat = std::exp(-std::pow(std::fmod(t * 1.3, 1.0) - 0.3, 2) / 0.01);
    const double z = -0.0065 * breath - 0.0045 * beat, x = 0.0022 * breath + 0.0016 * beat, y = 0.3 * x;
    const bool lost = i % 700 > 660 && i > 700, uncertain = !lost && i % 700 > 640 && i > 700;
    const double spread = lost ? 8 : 1;
    const double rx = 1.2e-4 * spread * noise(random), ry = 1e-4 * spread * noise(random),
                 rz = 2.5e-4 * spread * noise(random) - 0.00035 * beat;
    table.append({t, x, y, z, rx, ry, rz, std::sqrt(rx * rx + ry * ry + rz * rz), z + rz,
                  lost ? none : 0.2 * std::abs(noise(random)),
                  lost        ? 0.1
                  : uncertain ? 0.5
                              : 0.95 + 0.01 * noise(random),
                  lost        ? 2.0
                  : uncertain ? 1.0
                              : 0.0});
  }
  return table;
}

inline cv::Mat synthetic_picture() {
  cv::Mat noise(30, 40, CV_8UC3), picture;
  cv::theRNG().state = 3;
  cv::randu(noise, cv::Scalar(20, 20, 110), cv::Scalar(80, 70, 220));
  cv::resize(noise, picture, {640, 480}, 0, 0, cv::INTER_CUBIC);
  cv::polylines(picture, std::vector<cv::Point>{{250, 180}, {390, 190}, {385, 310}, {245, 300}}, true, {80, 255, 80}, 2,
                cv::LINE_AA);
  return picture;
}

inline tools::Report synthetic_report(const tools::TimeTable& table) {
  tools::Report report;
  report.title = "servo pig_2007";
  report.headline =
      "The tip stands still on the beating heart to 0.41 mm RMS; the heart itself moves by 11.2 mm peak to peak, so "
      "91 % of its motion is cancelled.";
  report.headline_number = "0.41";
  report.headline_unit = "mm RMS residual";
  report.notices = {"Ended by Ctrl-C after 25 s of 60 s; all numbers are of these 25 s."};
  report.table = &table;
  report.states = {{"tracking", "tracking/state"}};
  report.plots = {
      {"Residual against motion", "mm", {{"heart z", "heart/z_m"}, {"residual", "residual/norm_m"}}, 1000, "", nullptr},
      {"Heart motion", "mm", {{"x", "heart/x_m"}, {"y", "heart/y_m"}, {"z", "heart/z_m"}}, 1000, "", nullptr},
      {"Residual per axis",
       "mm",
       {{"x", "residual/x_m"}, {"y", "residual/y_m"}, {"z", "residual/z_m"}},
       1000,
       "True tip to true goal point.",
       nullptr},
      {"Tracking error", "px", {{"mean of the corners", "tracking/error_px"}}, 1, "", nullptr},
      {"Tracking quality", "", {{"quality", "tracking/quality"}}, 1, "", nullptr}};
  report.pictures = {{"Endoscope, first frame; green: the tracked region", synthetic_picture()},
                     {"Last frame", synthetic_picture()}};
  report.tables = {
      {"Run", {}, {{"Scene", "scenes/pig_2007.yaml"}, {"Tracker", "esm"}, {"Frames", "1900 at 60 Hz"}}, ""},
      {"Residual",
       {"", "RMS mm", "95 % mm", "max mm"},
       {{"x", "0.12", "0.24", "0.51"}, {"y", "0.10", "0.20", "0.44"}, {"z", "0.37", "0.71", "1.62"}},
       "After 2 s of settling."}};
  report.config_yaml = "scene: pig_2007\nloop:\n  latency_s: 0.016\n  note: \"</script><b>&\"\n";
  report.summary = {
      {"command", "servo"}, {"version", "0.1.0"}, {"note", "</script>"}, {"residual", {{"rms_mm", 0.41}}}};
  return report;
}

}  // namespace heartservo::test
