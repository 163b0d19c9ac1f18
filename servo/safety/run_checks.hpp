#pragma once
// What is refused before a run: a loop that cannot be stable, delays that no prediction bridges, limits that leave no
// room.
#include <string>
#include <vector>

#include "servo/loop/loop_options.hpp"
#include "servo/robot/tool_robot.hpp"

namespace heartservo::servo {

/// The gain (1/s) above which a proportional law on a delayed measurement is unstable: where the sampled loop (robot,
/// hold and `latency_s` exactly as they are between two commands) reaches -1 (Nyquist).
double largest_stable_gain(double latency_s, double period_s, const ToolRobotData& robot);

/// Every reason to refuse the run, each naming its key; empty for none. `controller`: the law's name.
std::vector<std::string> reasons_to_refuse(const LoopOptions& options, const std::string& controller,
                                           const ToolRobotData& robot);

}  // namespace heartservo::servo
