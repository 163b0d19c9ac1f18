#pragma once
#include <Eigen/Core>
#include <string>
#include <vector>

#include "servo/control/registry.hpp"
#include "servo/prediction/registry.hpp"
#include "servo/robot/tip_estimator.hpp"
#include "servo/safety/command_guard.hpp"
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
  double frame_rate_hz = 125;  // not a key: from the camera
  PredictorOptions prediction;
  ControlOptions control;
  GuardOptions guard;
  TipOptions tip;

  void fields(FieldVisitor& v) {
    v.group("latency", "parts of the loop's latency", latency);
    v.field({"offset_m", "m",
             "the surgeon's wanted offset of the tip from the target, carried by the heart (target frame: "
             "x right, y down, z into the tissue)"},
            offset_m);
    v.group("prediction", "options of the predictors", prediction);
    v.group("control", "options of the control laws", control);
    v.group("guard", "limits on every command, and what ends a run", guard);
    v.group("tip", "where the tip is taken from", tip);
  }
  std::vector<std::string> validate() const { return guard.validate(); }
};

}  // namespace heartservo::servo
