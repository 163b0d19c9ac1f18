#pragma once
#include <string>
#include <vector>

#include "tracking/settings/fields.hpp"

namespace heartservo::sim {

/// The ECG that a scene's loop gets beside the frames.
struct EcgOptions {
  std::string source = "off";
  std::string record, lead;
  double start_s = 10;
  double lead_in_s = 5;
  double rate_hz = 250;
  double noise_mv = 0.02, wander_mv = 0.1, hum_mv = 0.02;

  void fields(FieldVisitor& v) {
    v.choice({"source", "", "the loop's ECG: none, one simulated from the heart's beats, or a recorded one"}, source,
             {"off", "simulated", "recorded"});
    v.field({"record", "",
             "recorded: WFDB header (.hea) or CSV (time_s and a column a lead), relative to the scene; the heart beats "
             "with its labels (.atr beside it, or motion.beats)"},
            record);
    v.field({"lead", "", "recorded: which lead; empty: the first"}, lead);
    v.field({"start_s", "s", "recorded: where in the record, and in motion.beats, the run begins", 0, 1e6}, start_s);
    v.field({"lead_in_s", "s", "how long before the run the ECG was connected", 0, 60}, lead_in_s);
    v.field({"rate_hz", "Hz", "simulated: samples per second", 100, 10000}, rate_hz);
    v.field({"noise_mv", "mV", "simulated: standard deviation of white noise; the R wave has 1 mV", 0, 10}, noise_mv);
    v.field({"wander_mv", "mV", "simulated: amplitude of the baseline's wander", 0, 10}, wander_mv);
    v.field({"hum_mv", "mV", "simulated: amplitude of the mains' 50 Hz", 0, 10}, hum_mv);
  }
  /// Every problem at once, empty when usable.
  std::vector<std::string> validate() const {
    std::vector<std::string> problems;
    if (source == "recorded" && record.empty()) problems.emplace_back("ecg.source is recorded: ecg.record is missing");
    if (source != "recorded" && !record.empty())
      problems.emplace_back("ecg.record is given, but ecg.source is not recorded");
    return problems;
  }
};

}  // namespace heartservo::sim
