#include "tools/track_truth.hpp"

#include "servo/loop/loop_record.hpp"
#include "servo/loop/score.hpp"
#include "sim/table/table.hpp"

namespace heartservo::tools {

namespace {

constexpr const char* kTarget = "target";

}  // namespace

Eigen::Vector2d true_target_px(const sim::Table& table, const servo::TruthSample& truth) {
  return truth.target ? table.camera().project(*truth.target) : region_centre(*truth.corners_px, {});
}

TruthSource truth_of(const sim::Table& table, std::size_t region) {
  if (table.reference() != "truth") return {};
  const auto at = [&table, region](const tracking::Frame& frame) {
    servo::LoopRecord record;
    record.frame.time_s = frame.time_s;
    record.frame.sequence = frame.sequence;
    const auto sample = table.truth(record, region);
    TrackTruth truth{sample.corners_px, true_target_px(table, sample)};
    if (sample.target) truth.position = *sample.target;
    return truth;
  };
  return {"truth", {true, kTarget, table.region_side_m(region) > 0}, at};
}

TruthSource truth_of(const CornerTruth& truth, const std::string& file) {
  TruthKind kind{true, std::nullopt, false};
  if (truth.has_target()) kind.point = kTarget;
  return {file, kind, [&truth](const tracking::Frame& frame) {
            return TrackTruth{truth.at(frame.time_s), truth.target_at(frame.time_s)};
          }};
}

void add_point(TruthSource& source, const std::string& file, const sim::PointTrack& point) {
  source.reference += (source.reference.empty() ? "" : ", ") + file;
  source.kind.point = point.name;
  source.at = [at = source.at, point](const tracking::Frame& frame) {
    TrackTruth truth = at(frame);
    truth.point = point.at(frame.sequence, frame.time_s);
    return truth;
  };
}

}  // namespace heartservo::tools
