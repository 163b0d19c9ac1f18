#pragma once
#include <Eigen/Core>
#include <string>
#include <vector>

#include "servo/control/control_options.hpp"
#include "servo/control/force_loop.hpp"
#include "servo/control/surgeon_path.hpp"
#include "servo/prediction/registry.hpp"
#include "servo/robot/tip_estimator.hpp"
#include "servo/safety/guard_options.hpp"
#include "tracking/settings/fields.hpp"

namespace heartservo::servo {

/// A frame is stamped at mid-exposure; its command acts the sum of these later.
struct LatencyOptions {
  double exposure_s = 0.004, transfer_s = 0.008, processing_s = 0.008, actuation_s = 0.004;

  double total_s() const { return exposure_s + transfer_s + processing_s + actuation_s; }
  /// Keeps the parts' proportions.
  void set_total(double total) {
    const double now = total_s();
    if (now <= 0) {
      *this = {0, 0, total, 0};
      return;
    }
    for (double* part : {&exposure_s, &transfer_s, &processing_s, &actuation_s}) *part *= total / now;
  }

  void fields(FieldVisitor& v) {
    v.field({"exposure_s", "s", "from mid-exposure to the end of read-out", 0, 1}, exposure_s);
    v.field({"transfer_s", "s", "from the sensor to memory", 0, 1}, transfer_s);
    v.field({"processing_s", "s", "time set aside for tracking, prediction and control", 0, 1}, processing_s);
    v.field({"actuation_s", "s", "from the command to the drives", 0, 1}, actuation_s);
  }
};

struct LoopOptions {
  LatencyOptions latency;
  Eigen::Vector3d offset_m{0, 0, 0};
  // not keys: from the camera, and from the tool
  double frame_rate_hz = 125;
  Eigen::Vector3d tool_axis{0, 0, -1};  ///< from the tip along the shaft, camera frame
  PredictorOptions prediction;
  ControlOptions control;
  GuardOptions guard;
  TipOptions tip;
  PathOptions path;
  ForceOptions force;
  bool eye_in_hand = false;
  std::vector<PathPoint> recorded_path;  // not a key: from the file that `path` names

  void fields(FieldVisitor& v) {
    v.group("latency", "parts of the loop's latency", latency);
    v.field({"offset_m", "m",
             "the surgeon's wanted offset of the tip from the target, carried by the heart (target frame: "
             "x right, y down, z into the tissue)"},
            offset_m);
    v.group("prediction", "options of the predictors", prediction);
    v.group("control", "options of the control laws", control);
    v.group("guard", "limits on every command, what ends a run, what happens without a target", guard);
    v.group("path", "what the surgeon's hand adds: a path relative to the heart, from offset_m", path);
    v.group("force", "pressing on the tissue", force);
    v.field({"eye_in_hand", "",
             "true: the robot carries the endoscope, and the place where the first picture shows the goal is held"},
            eye_in_hand);
    v.group("tip", "where the tip is taken from", tip);
  }
  std::vector<std::string> validate() const {
    std::vector<std::string> problems = guard.validate();
    for (const auto& problem : path.validate()) problems.push_back(problem);
    return problems;
  }
};

}  // namespace heartservo::servo
