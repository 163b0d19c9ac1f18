#pragma once
// Options with a field of every kind, nested and listed.
#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "tracking/settings/fields.hpp"

namespace heartservo::test {

struct LandmarkOptions {
  double x_m = 0.001;
  std::string name = "spot";

  void fields(FieldVisitor& v) {
    v.field({"x_m", "m", "where it is", -0.1, 0.1}, x_m);
    v.field({"name", "", "what it is called"}, name);
  }
};

struct LoopOptions {
  double latency_s = 0.016;
  std::string tracker = "esm";
  Eigen::Vector3d offset_m{0, 0, 0.01};

  void fields(FieldVisitor& v) {
    v.field({"latency_s", "s", "from exposure to motion", 0, 1}, latency_s);
    v.choice({"tracker", "", "who follows the target"}, tracker, {"esm", "ssd", "optical_flow"});
    v.field({"offset_m", "m", "desired offset"}, offset_m);
  }
};

struct ExampleOptions {
  int frames = 1900;
  bool noise = true;
  std::string title = "pig | 2007";
  double rate_hz = 60;
  double limit_m = std::numeric_limits<double>::infinity();  // none unless given
  std::string engine;                                        // none unless chosen
  std::vector<double> gains{1, 0.5};
  LoopOptions loop;
  std::vector<LandmarkOptions> landmarks;

  void fields(FieldVisitor& v) {
    v.field({"frames", "", "how many", 1, 1e6}, frames);
    v.field({"noise", "", "with noise"}, noise);
    v.field({"title", "", "shown in the report"}, title);
    v.field({"rate_hz", "Hz", "frames a second", 1}, rate_hz);
    v.field({"limit_m", "m", "how far"}, limit_m);
    v.choice({"engine", "", "what drives it"}, engine, {"fast", "slow"});
    v.field({"gains", "", "one per axis"}, gains, 0);
    v.group("loop", "The closed loop.", loop);
    v.list("landmarks", "Points on the heart.", landmarks);
  }
};

}  // namespace heartservo::test
