#include "sim/sequence/sequence_table.hpp"

#include <stdexcept>

#include "servo/loop/loop_record.hpp"
#include "sim/sequence/artificial_sequence.hpp"

namespace heartservo::sim {

namespace {

class SequenceTable final : public Table {
 public:
  explicit SequenceTable(const SequenceOptions& options)
      : sequence_(options), camera_(tracking::Camera::pinhole(sequence_.size().width, sequence_.size().height, 0.9)) {}

  tracking::FrameSource& frames() override { return sequence_; }
  servo::ToolRobot& robot() override { throw std::logic_error("an artificial sequence has no robot"); }
  const tracking::Camera& camera() const override { return camera_; }
  HandPicked picked(std::size_t) const override {
    HandPicked picked;
    picked.target = sequence_.region();
    return picked;
  }
  Eigen::Vector3d marker_to_tip() const override { return Eigen::Vector3d::Zero(); }
  Eigen::Vector3d tool_axis() const override { return {0, 0, -1}; }
  Eigen::Vector3d offset() const override { return Eigen::Vector3d::Zero(); }
  double region_side_m(std::size_t) const override { return 0; }
  double marker_side_m() const override { return 0; }
  servo::TruthSample truth(const servo::LoopRecord& record, std::size_t) const override {
    servo::TruthSample truth;
    truth.corners_px = sequence_.corners(record.frame.sequence);
    return truth;
  }
  std::string reference() const override { return "truth"; }

 private:
  ArtificialSequence sequence_;
  tracking::Camera camera_;
};

}  // namespace

std::unique_ptr<Table> make_sequence_table(const SequenceOptions& options) {
  return std::make_unique<SequenceTable>(options);
}

}  // namespace heartservo::sim
