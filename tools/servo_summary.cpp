#include "tools/servo_summary.hpp"

#include <fmt/format.h>

#include "servo/loop/score.hpp"
#include "sim/scene/scene.hpp"

namespace heartservo::tools {

namespace {

using nlohmann::json;

json xyz(const Eigen::Vector3d& v) { return {{"x", v.x()}, {"y", v.y()}, {"z", v.z()}}; }

json std_max(const servo::ScoreSummary& s) {
  json j;
  for (int i = 0; i < 3; ++i)
    j[std::string(1, "xyz"[i])] = {{"std", 1e3 * s.position_error_std[i]}, {"max", 1e3 * s.position_error_max[i]}};
  return j;
}

}  // namespace

json servo_summary(const servo::ScoreSummary& s, const sim::Scene& scene, const ServoRunFacts& facts) {
  json j;
  j["command"] = "servo";
  j["version"] = HEARTSERVO_VERSION;
  j["scene"] = facts.scene;
  j["seed"] = scene.seed;
  j["frames"] = s.frames;
  j["scored_frames"] = s.scored_frames;
  j["frame_rate_hz"] = facts.frame_rate_hz;
  j["latency_ms"] = 1e3 * scene.loop.latency.total_s();
  j["tracker"] = scene.engines.tracker;
  j["estimator"] = scene.engines.estimator;
  j["predictor"] = scene.engines.predictor;
  j["controller"] = scene.engines.controller;
  j["robot"] = scene.robot.type;
  j["camera"] = facts.camera;
  j["settle_s"] = scene.settle_s;
  j["interrupted"] = facts.interrupted;
  j["stop_reason"] = facts.stop_reason.empty() ? json() : json(facts.stop_reason);
  const bool moved = s.metric ? s.motion_rms > 0 : s.motion_px.rms > 0;
  if (s.metric) {
    j["motion"] = {{"rms_mm", 1e3 * s.motion_rms}, {"peak_to_peak_mm", xyz(1e3 * s.motion_peak_to_peak)}};
    j["residual"] = {{"rms_mm", 1e3 * s.residual.rms},
                     {"p95_mm", 1e3 * s.residual.p95},
                     {"max_mm", 1e3 * s.residual.max},
                     {"axis_rms_mm", xyz(1e3 * s.residual_axis_rms)}};
    j["reduction_percent"] = moved ? json(s.reduction_percent) : json();
  } else {
    j["motion"] = nullptr;
    j["residual"] = nullptr;
    j["reduction_percent"] = s.residual_px.count > 0 && moved ? json(s.reduction_percent_px) : json();
  }
  // a score of no frames is none: 0 would read as perfect
  const auto px = [&](double value) { return s.residual_px.count > 0 ? json(value) : json(); };
  j["motion_px"] = {{"rms", px(s.motion_px.rms)}};
  j["residual_px"] = {
      {"rms", px(s.residual_px.rms)}, {"p95", px(s.residual_px.p95)},
      {"max", px(s.residual_px.max)}, {"frames", s.residual_px.count},
      {"reference", facts.reference}, {"point", facts.reference_point.empty() ? json() : json(facts.reference_point)}};
  j["tracking"] = {{"lost_frames", s.lost_frames},
                   {"uncertain_frames", s.uncertain_frames},
                   {"unreadable_frames", s.unreadable_frames},
                   {"relocks", s.relocks},
                   {"error_px", nullptr},
                   {"position_error_mm", nullptr}};
  if (s.corner_error_px.count > 0)
    j["tracking"]["error_px"] = {
        {"mean", s.corner_error_px.mean}, {"std", s.corner_error_px.std}, {"max", s.corner_error_px.max}};
  if (s.metric && s.lost_frames < s.frames) j["tracking"]["position_error_mm"] = std_max(s);
  if (scene.loop.force.on())
    j["force"] = {{"wanted_n", scene.loop.force.wanted_n},
                  {"error_rms_n", s.force_error.count > 0 ? json(s.force_error.rms) : json()},
                  {"error_max_n", s.force_error.count > 0 ? json(s.force_error.max) : json()},
                  {"peak_n", s.force_peak_n},
                  {"touches", s.touches},
                  {"scored_frames", s.force_error.count}};
  j["commands"] = {{"max_speed_mm_s", 1e3 * s.max_speed},
                   {"max_step_mm", 1e3 * s.max_step_m},
                   {"limited", s.limited_commands},
                   {"safety_stops", facts.stop_reason.empty() ? 0 : 1}};
  j["timing"] = {{"track_ms", {{"p50", s.track_ms_p50}, {"p99", s.track_ms_p99}, {"max", s.track_ms_max}}},
                 {"chain_ms", {{"p50", s.chain_ms_p50}, {"p99", s.chain_ms_p99}, {"max", s.chain_ms_max}}},
                 {"real_time_factor", facts.real_time_factor}};
  return j;
}

std::string number(const json& value, int decimals) {
  return value.is_number() ? fmt::format("{:.{}f}", value.get<double>(), decimals) : "-";
}

std::string reference_text(const json& residual_px) {
  const std::string reference = residual_px["reference"];
  return residual_px["point"].is_null() ? reference : reference + ", point " + residual_px["point"].get<std::string>();
}

std::string residual_table(const json& j) {
  const bool metric = !j["residual"].is_null();
  std::string t = fmt::format(
      "{}: {} frames, {} scored after {} s, {} + {} + {}, latency {} ms\n\n", j["scene"].get<std::string>(),
      j["frames"].get<int>(), j["scored_frames"].get<int>(), number(j["settle_s"], 1), j["tracker"].get<std::string>(),
      j["predictor"].get<std::string>(), j["controller"].get<std::string>(), number(j["latency_ms"], 0));
  const auto row = [&](const std::string& name, const std::vector<std::string>& cells) {
    t += fmt::format("{:<22}", name);
    for (const auto& cell : cells) t += fmt::format("{:>10}", cell);
    t += "\n";
  };
  if (metric) {
    const json &motion = j["motion"], &residual = j["residual"], &p2p = motion["peak_to_peak_mm"],
               &axis = residual["axis_rms_mm"];
    row("mm", {"3D RMS", "95 %", "max", "x", "y", "z"});
    row("heart motion (p-p)",
        {number(motion["rms_mm"], 3), "", "", number(p2p["x"], 3), number(p2p["y"], 3), number(p2p["z"], 3)});
    row("residual (RMS)", {number(residual["rms_mm"], 3), number(residual["p95_mm"], 3), number(residual["max_mm"], 3),
                           number(axis["x"], 3), number(axis["y"], 3), number(axis["z"], 3)});
  }
  const json& px = j["residual_px"];
  row("px", {"RMS", "95 %", "max"});
  row("motion", {number(j["motion_px"]["rms"], 2)});
  row("residual", {number(px["rms"], 2), number(px["p95"], 2), number(px["max"], 2)});
  t += fmt::format("{:<22}{:>10}\n", "scored against", reference_text(px));
  if (j.contains("still_view") && !j["still_view"].is_null())
    t += fmt::format("\nstill view: the region moves by {} px in the picture, {} px in the still one\n",
                     number(j["still_view"]["raw_px"], 2), number(j["still_view"]["still_px"], 2));
  if (j.contains("force"))
    t += fmt::format("\nforce {} N wanted: error {} N RMS, {} N at most; peak {} N; {} touches\n",
                     number(j["force"]["wanted_n"], 2), number(j["force"]["error_rms_n"], 3),
                     number(j["force"]["error_max_n"], 3), number(j["force"]["peak_n"], 3),
                     j["force"]["touches"].get<int>());
  t += fmt::format("\nmotion cancelled {} %, lost frames {}, uncertain {}, found again {}\n",
                   number(j["reduction_percent"], 1), j["tracking"]["lost_frames"].get<int>(),
                   j["tracking"]["uncertain_frames"].get<int>(), j["tracking"]["relocks"].get<int>());
  t += fmt::format("chain {} ms (p50), {} ms (p99); {} x real time\n", number(j["timing"]["chain_ms"]["p50"], 3),
                   number(j["timing"]["chain_ms"]["p99"], 3), number(j["timing"]["real_time_factor"], 1));
  if (!j["stop_reason"].is_null()) t += "SAFETY STOP: " + j["stop_reason"].get<std::string>() + "\n";
  if (j["interrupted"].get<bool>()) t += "ended by Ctrl-C\n";
  return t;
}

}  // namespace heartservo::tools
