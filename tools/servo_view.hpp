#pragma once
#include <string>

#include "tools/window/window_view.hpp"

namespace heartservo::servo {
struct LoopRecord;
struct TruthSample;
}  // namespace heartservo::servo
namespace heartservo::tracking {
struct Camera;
}

namespace heartservo::tools {

/// What the live window shows of a frame of the loop. Goal and tip are the true ones where they are known, else those
/// that the loop believes in, through `camera`. `reference`: of the pixel residual; `latency_s`: of the scene.
WindowView servo_view(const servo::LoopRecord& record, const servo::TruthSample& truth, const tracking::Camera& camera,
                      const std::string& reference, double latency_s);

}  // namespace heartservo::tools
