// A recorded sequence with a virtual tool: the robot is simulated, its tool is drawn into each frame, so that the loop
// sees what it would see. The region's depth is assumed; there is no 3D truth.
#include <fmt/format.h>

#include <cmath>

#include "servo/loop/loop_record.hpp"
#include "sim/endoscope/painted_pattern.hpp"
#include "sim/endoscope/tool_view.hpp"
#include "sim/robot/registry.hpp"
#include "sim/scene/scene.hpp"
#include "sim/table/heart_beats.hpp"
#include "sim/table/point_tracks.hpp"
#include "sim/table/table.hpp"
#include "tracking/frames/open_source.hpp"
#include "tracking/frames/stereo_pair.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::sim {

namespace {

constexpr double kClearance = 1.25;  // the tip stays this much outside the region's corner unless an offset is given

class RecordedTable final : public Table, private tracking::FrameSource {
 public:
  RecordedTable(const Scene& scene, std::unique_ptr<tracking::FrameSource> opened)
      : scene_(scene),
        source_(both_views(scene, opened ? std::move(opened) : open_recording(scene))),
        camera_(camera_of(scene, source_->size().width, source_->size().height)),
        stereo_(stereo_of(scene)),
        region_(picked_region()),
        side_(roomier_side()),
        offset_(chosen_offset()),
        tool_(tool_from(side_)),
        view_(camera_, tool_),
        robot_(make_robot({scene.robot, target_start() + offset_ + scene.robot.start_error_m, tool_axis(),
                           static_cast<std::uint64_t>(scene.seed)})) {
    offset_px_ = camera_.project(target_start() + offset_) - camera_.project(target_start());
    if (!scene.recording.reference.empty()) find_reference(resolve(scene, scene.recording.reference));
  }

  tracking::FrameSource& frames() override { return *this; }
  servo::ToolRobot& robot() override { return *robot_; }
  const tracking::Camera& camera() const override { return camera_; }
  Eigen::Vector3d marker_to_tip() const override { return -tool_.marker_offset_m; }
  Eigen::Vector3d tool_axis() const override { return tool_.direction.normalized(); }
  Eigen::Vector3d offset() const override { return offset_; }
  double region_side_m(std::size_t) const override { return 0; }
  double marker_side_m() const override { return tool_.marker_side_m; }
  std::string reference() const override { return reference_ ? reference_->file : "tracked"; }
  std::string reference_point() const override { return reference_ ? reference_->point.name : ""; }

  std::optional<tracking::StereoCamera> stereo() const override { return stereo_; }
  std::unique_ptr<servo::EcgSource> ecg() const override { return heart_ecg(scene_, {}, 0); }

  HandPicked picked(std::size_t region) const override {
    const auto corners = marker_corners(tool_, start_tip_);
    HandPicked picked;
    picked.target = picked_region(region);
    if (scene_.depth.source == "distance")
      picked.scale = tracking::known_scale({scene_.recording.depth_m, scene_.depth.sigma_m});
    else if (scene_.depth.source == "stereo" && stereo_)
      picked.scale = tracking::stereo_scale(*stereo_, scene_.stereo.matching);
    picked.marker_edge_ratio = kFrameEdge;
    picked.marker_plate = pattern_picture(kMarkerPattern);
    for (std::size_t i = 0; i < 4; ++i) picked.marker[i] = camera_.project(corners[i]);
    return picked;
  }

  servo::TruthSample truth(const servo::LoopRecord& record, std::size_t) const override {
    servo::TruthSample truth;
    truth.tip_px = camera_.project(tip_);
    if (reference_)
      truth.goal_px = reference_->point.at(record.frame.sequence, record.frame.time_s) + reference_->goal_from_point_px;
    else if (record.goal_now.allFinite())
      truth.goal_px = camera_.project(record.goal_now);
    return truth;
  }

 private:
  struct Reference {
    std::string file;
    PointTrack point;
    Eigen::Vector2d goal_from_point_px;
  };

  bool next(tracking::Frame& frame) override {
    if (count_ >= limit_ || !source_->next(frame)) return false;
    if (count_ == 0 && frame.status != tracking::FrameStatus::OK)
      throw InputError(frame.note + "; the first frame must show the region");
    ++count_;
    robot_->advance_to(frame.time_s);
    tip_ = robot_->true_tip_camera();
    if (frame.status != tracking::FrameStatus::OK || !scene_.show_tool) return true;
    frame.grey = frame.grey.clone();  // the source may keep its own
    if (!frame.colour.empty()) frame.colour = frame.colour.clone();
    draw_tool(view_, {tip_, robot_->true_turn_camera()}, frame.grey, frame.colour.empty() ? nullptr : &frame.colour);
    return true;
  }
  cv::Size size() const override { return source_->size(); }
  double frame_rate_hz() const override { return source_->frame_rate_hz(); }
  std::optional<std::size_t> frame_count() const override {
    const auto count = source_->frame_count();
    if (!count && source_->live() && limit_ < SIZE_MAX) return limit_;
    return count ? std::min(*count, limit_) : count;
  }
  std::string description() const override { return source_->description(); }
  tracking::LiveSource* live() override { return source_->live(); }

  // Against a named point the goal is carried as by a hand that holds on to the point: it keeps its distance in pixels.
  void find_reference(const std::string& file) {
    const PointTracks tracks = PointTracks::read(file);
    reference_ = Reference{file, tracks.choose(scene_.recording.point, region_), offset_px_};
    if (!reference_->point.name.empty())
      reference_->goal_from_point_px += tracking::centre(region_) - reference_->point.at(0, 0);
  }

  static std::unique_ptr<tracking::FrameSource> both_views(const Scene& scene,
                                                           std::unique_ptr<tracking::FrameSource> left) {
    if (scene.recording.right.empty()) return left;
    return tracking::pair_views(
        std::move(left), tracking::open_source(resolve(scene, scene.recording.right), scene.camera.frame_rate_hz));
  }
  static std::optional<tracking::StereoCamera> stereo_of(const Scene& scene) {
    if (scene.recording.right.empty()) return std::nullopt;
    const std::string file = resolve(scene, scene.camera.calibration);
    if (!tracking::is_stereo_file(file))
      throw InputError(file + ": is no stereo calibration (it has no M2); a right view needs both cameras and where "
                              "they stand, as 'heartservo calibrate' writes them for a stereo pair");
    return tracking::read_stereo_camera(file);
  }

  tracking::Quad picked_region(std::size_t region = 0) const {
    const auto& roi = scene_.recording.roi;
    const double w = camera_.width, h = camera_.height;
    if (const std::size_t i = 4 * region; roi.size() >= i + 4)
      return tracking::rectangle(roi[i], roi[i + 1], roi[i + 2], roi[i + 3]);
    const double side = std::round(0.2 * std::min(w, h));  // without a choice: the middle of the picture
    return tracking::rectangle(std::round((w - side) / 2), std::round((h - side) / 2), side, side);
  }
  Eigen::Vector3d on_depth(const Eigen::Vector2d& pixel) const {
    const Eigen::Vector2d n = camera_.normalise(pixel);
    return scene_.recording.depth_m * Eigen::Vector3d(n.x(), n.y(), 1);
  }
  Eigen::Vector3d target_start() const { return on_depth(tracking::centre(region_)); }
  // The side of the region, as signs of x and y, on which the picture has more room for the tool.
  Eigen::Vector2d roomier_side() const {
    const Eigen::Vector2d c = tracking::centre(region_);
    return {c.x() < 0.5 * camera_.width ? 1 : -1, c.y() < 0.5 * camera_.height ? 1 : -1};
  }
  Eigen::Vector3d chosen_offset() const {
    if (!scene_.loop.offset_m.isZero()) return scene_.loop.offset_m;
    const std::size_t corner = side_.y() > 0 ? (side_.x() > 0 ? 2 : 3) : (side_.x() > 0 ? 1 : 0);
    return kClearance * (on_depth(region_[corner]) - target_start());
  }
  ToolOptions tool_from(const Eigen::Vector2d& side) const {
    ToolOptions tool = scene_.tool;
    for (Eigen::Vector3d* v : {&tool.direction, &tool.marker_offset_m})
      v->head<2>() = v->head<2>().cwiseAbs().cwiseProduct(side);
    return tool;
  }

  Scene scene_;
  std::unique_ptr<tracking::FrameSource> source_;
  tracking::Camera camera_;
  std::optional<tracking::StereoCamera> stereo_;
  tracking::Quad region_;
  Eigen::Vector2d side_;
  Eigen::Vector3d offset_;
  ToolOptions tool_;
  ToolView view_;
  std::unique_ptr<SimulatedRobot> robot_;
  std::optional<Reference> reference_;
  Eigen::Vector2d offset_px_;
  Eigen::Vector3d tip_ = robot_->true_tip_camera();
  Eigen::Vector3d start_tip_ = tip_;
  std::size_t count_ = 0, limit_ = scene_.max_frames > 0 ? scene_.max_frames : SIZE_MAX;
};

}  // namespace

std::unique_ptr<tracking::FrameSource> open_recording(const Scene& scene) {
  return tracking::open_source(resolve(scene, scene.recording.source), scene.camera.frame_rate_hz);
}

std::unique_ptr<Table> make_recorded_table(const Scene& scene, std::unique_ptr<tracking::FrameSource> opened) {
  return std::make_unique<RecordedTable>(scene, std::move(opened));
}

}  // namespace heartservo::sim
