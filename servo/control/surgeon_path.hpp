#pragma once
// What the surgeon's hand adds: a path of the tip relative to the heart, in the target's frame (x right, y down, z into
// the tissue), from the wanted offset. A person on a master arm sees the still picture and moves as on a still heart;
// here the motion comes from a figure or a recorded file.
#include <Eigen/Core>
#include <string>
#include <vector>

#include "tracking/settings/fields.hpp"

namespace heartservo::servo {

struct PathOptions {
  std::string type = "hold";
  std::string file;
  double start_s = 1;
  double period_s = 4;
  double size_m = 0.002;
  double depth_m = 0.0005;
  double pitch_m = 0.0015;
  int stitches = 3;

  void fields(FieldVisitor& v) {
    v.choice({"type", "", "hold: none; circle: in the tissue's plane; suture: stitches across a vessel; file"}, type,
             {"hold", "circle", "suture", "file"});
    v.field({"file", "", "CSV with time_s, x_m, y_m, z_m, relative to the scene: a recorded hand"}, file);
    v.field({"start_s", "s", "when it begins", 0, 1e5}, start_s);
    v.field({"period_s", "s", "of a turn of the circle, or of a stitch", 0.2, 1e3}, period_s);
    v.field({"size_m", "m", "radius of the circle; width of a stitch", 0, 0.05}, size_m);
    v.field({"depth_m", "m", "of a stitch into the tissue", 0, 0.02}, depth_m);
    v.field({"pitch_m", "m", "from a stitch to the next", 0, 0.02}, pitch_m);
    v.field({"stitches", "", "number of stitches", 1, 100}, stitches);
  }
  std::vector<std::string> validate() const;
};

struct PathPoint {
  double time_s = 0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< m
};

class SurgeonPath {
 public:
  /// `recorded`: the points of a path of type file, times increasing; between them it is smooth (Catmull and Rom).
  explicit SurgeonPath(const PathOptions& options = {}, std::vector<PathPoint> recorded = {});

  Eigen::Vector3d position(double time_s) const;  ///< m, target frame
  Eigen::Vector3d velocity(double time_s) const;  ///< m/s
  double reach_m() const { return reach_; }       ///< largest distance from the start
  bool is_still() const { return options_.type == "hold"; }

 private:
  Eigen::Vector3d recorded_at(double time_s) const;
  Eigen::Vector3d tangent(std::size_t i) const;

  PathOptions options_;
  std::vector<PathPoint> recorded_;
  double reach_ = 0;
};

}  // namespace heartservo::servo
