#include "tools/servo_view.hpp"

#include <fmt/format.h>

#include <cmath>

#include "servo/loop/loop_record.hpp"
#include "servo/loop/score.hpp"
#include "tracking/camera/camera.hpp"

namespace heartservo::tools {

namespace {

const char* name_of(servo::LoopMode mode) {
  switch (mode) {
    case servo::LoopMode::FOLLOW:
      return "FOLLOW";
    case servo::LoopMode::COAST:
      return "COAST";
    case servo::LoopMode::HOLD:
      return "HOLD";
    case servo::LoopMode::RETRACT:
      return "RETRACT";
    case servo::LoopMode::RESUME:
      return "RESUME";
  }
  return "";
}

std::string residual_line(const servo::LoopRecord& r, const servo::TruthSample& truth, const std::string& reference) {
  if (truth.tip && truth.goal)
    return fmt::format("residual {:6.3f} mm (truth)", 1e3 * (*truth.tip - *truth.goal).norm());
  if (const double px = (truth.tip_px - truth.goal_px).norm(); std::isfinite(px))
    return fmt::format("residual {:5.2f} px (against {})", px,
                       reference == "tracked" ? "the tracked region" : reference);
  if (r.goal_now.allFinite())
    return fmt::format("measured error {:6.3f} mm (tip and goal as the loop sees them)",
                       1e3 * (r.tip - r.goal_now).norm());
  return "residual unknown: the target is not seen";
}

std::string latency_line(const servo::LoopRecord& r, double latency_s) {
  if (std::isfinite(r.glass_to_command_s))
    return fmt::format("latency {:5.1f} ms from glass to command, picture {:.1f} ms old, computing {:.2f} ms",
                       1e3 * r.glass_to_command_s, 1e3 * r.age_s, r.chain_ms);
  return fmt::format("latency {:.1f} ms (the scene's), computing {:.2f} ms", 1e3 * latency_s, r.chain_ms);
}

}  // namespace

WindowView servo_view(const servo::LoopRecord& r, const servo::TruthSample& truth, const tracking::Camera& camera,
                      const std::string& reference, double latency_s) {
  WindowView view;
  view.time_s = r.frame.time_s;
  view.picture = r.frame.colour.empty() ? r.frame.grey : r.frame.colour;
  view.regions.push_back({r.track});
  if (r.marker_track.sequence > 0 || r.marker_track.quality > 0) view.regions.push_back({r.marker_track});
  const auto seen = [&](const Eigen::Vector3d& p) -> Eigen::Vector2d {
    return p.allFinite() && p.z() > 0 ? camera.project(p) : Eigen::Vector2d::Constant(NAN);
  };
  view.goal_px = truth.goal_px.allFinite() ? truth.goal_px : seen(r.goal_now);
  view.tip_px = truth.tip_px.allFinite() ? truth.tip_px : seen(r.tip);
  view.lines = {fmt::format("frame {}  {:.2f} s   tracking {} ({:.2f})   loop {}", r.frame.sequence, r.frame.time_s,
                            tracking::name_of(r.track.state), r.track.quality, name_of(r.mode)),
                residual_line(r, truth, reference), latency_line(r, latency_s)};
  return view;
}

}  // namespace heartservo::tools
