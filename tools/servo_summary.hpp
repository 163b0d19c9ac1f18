#pragma once
#include <nlohmann/json.hpp>
#include <string>

namespace heartservo::servo {
struct ScoreSummary;
}
namespace heartservo::sim {
struct Scene;
}

namespace heartservo::tools {

/// What a run is known by, beside its score.
struct ServoRunFacts {
  std::string scene;            ///< "pig_2007", or the source of a recorded run
  std::string reference;        ///< of the pixel residual
  std::string reference_point;  ///< the point of that file, "" where it names none
  std::string camera;           ///< calibration file or "assumed pinhole"
  double frame_rate_hz = 0;
  double real_time_factor = 0;
  bool interrupted = false;
  std::string stop_reason;  ///< "" unless the guard ended the run
};

/// summary.json of `servo`; the keys are a contract. Metric parts are null without 3D truth.
nlohmann::json servo_summary(const servo::ScoreSummary& score, const sim::Scene& scene, const ServoRunFacts& facts);

/// The residual table for the terminal.
std::string residual_table(const nlohmann::json& summary);

/// What `residual_px` of the summary is scored against: "truth", or "points.csv, point C".
std::string reference_text(const nlohmann::json& residual_px);

/// A value of the summary for people: "0.412", or "-" where it is null.
std::string number(const nlohmann::json& value, int decimals);

}  // namespace heartservo::tools
