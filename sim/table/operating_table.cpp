// The simulated operating table: heart, endoscope, robot and clock.
#include <cmath>
#include <random>

#include "servo/loop/loop_record.hpp"
#include "sim/endoscope/endoscope.hpp"
#include "sim/endoscope/painted_pattern.hpp"
#include "sim/robot/registry.hpp"
#include "sim/scene/scene.hpp"
#include "sim/table/heart_beats.hpp"
#include "sim/table/stages.hpp"
#include "sim/table/table.hpp"
#include "sim/tissue/feeling_robot.hpp"
#include "tracking/planar/quad.hpp"

namespace heartservo::sim {

namespace {

// Each consumer of randomness has its own stream of the scene's seed.
enum class Stream : std::uint64_t {
  MOTION = 1,
  SURFACE,
  PICTURE,
  ROBOT,
  HAND,
  RIGHT_PICTURE,
  ECG,
  FORCE,
  SWAB,
  RIGHT_SWAB
};
std::uint64_t stream_seed(int seed, Stream stream) {
  return static_cast<std::uint64_t>(seed) * 1000003ULL + static_cast<std::uint64_t>(stream);
}

class OperatingTable final : public Table, private tracking::FrameSource {
 public:
  explicit OperatingTable(const Scene& scene)
      : scene_(scene),
        path_(surgeon_path(scene)),
        camera_(camera_of(scene, 0, 0)),
        endoscope_(camera_,
                   HeartSurface(scene.surface, heart_motion(scene, stream_seed(scene.seed, Stream::MOTION)),
                                stream_seed(scene.seed, Stream::SURFACE)),
                   scene.picture, stream_seed(scene.seed, Stream::PICTURE), scene.tool),
        robot_(make_robot({scene.robot, goal_at(0) + scene.robot.start_error_m, tool_axis(),
                           stream_seed(scene.seed, Stream::ROBOT)})),
        feeling_(
            *robot_, [this](double t) { return force_at(t); }, scene.loop.force.on() ? scene.tissue.force_noise_n : 0,
            stream_seed(scene.seed, Stream::FORCE)) {
    if (scene.loop.eye_in_hand) start_goal_ = goal_at(0);
    if (!(scene.stereo.baseline_m > 0)) return;
    right_ =
        std::make_unique<Endoscope>(camera_, endoscope_.surface(), scene.picture,
                                    stream_seed(scene.seed, Stream::RIGHT_PICTURE), scene.tool, endoscope_.texture());
  }

  tracking::FrameSource& frames() override { return *this; }
  servo::ToolRobot& robot() override { return feeling_; }
  const tracking::Camera& camera() const override { return camera_; }
  Eigen::Vector3d marker_to_tip() const override { return -scene_.tool.marker_offset_m; }
  Eigen::Vector3d tool_axis() const override { return scene_.tool.direction.normalized(); }
  Eigen::Vector3d offset() const override { return scene_.loop.offset_m; }
  std::string reference() const override { return "truth"; }
  std::unique_ptr<servo::EcgSource> ecg() const override {
    return heart_ecg(scene_, beats(), stream_seed(scene_.seed, Stream::ECG));
  }
  std::vector<double> beats() const override { return endoscope_.surface().motion().beats(); }

  double marker_side_m() const override { return scene_.tool.marker_side_m; }
  double region_side_m(std::size_t region) const override {
    const TargetOptions& target = target_of(region);
    return target.landmark >= 0 ? scene_.surface.landmarks[index_of(target)].side_m : target.side_m;
  }
  std::optional<tracking::StereoCamera> stereo() const override {
    if (!right_) return std::nullopt;
    tracking::StereoCamera stereo{camera_, camera_};
    stereo.T_right_left.translation().x() = -scene_.stereo.baseline_m;
    return stereo;
  }

  HandPicked picked(std::size_t region) const override {
    const TargetOptions& target = target_of(region);
    std::mt19937_64 random(stream_seed(scene_.seed, Stream::HAND) + 7919 * region);
    std::uniform_real_distribution<double> shake(-target.pick_error_px, target.pick_error_px);
    const auto pick = [&](tracking::Quad quad) {
      for (auto& corner : quad) {
        const double u = shake(random), v = shake(random);
        corner += Eigen::Vector2d(u, v);
      }
      return quad;
    };
    HandPicked picked;
    picked.target = pick(region_at(target, 0));
    picked.target_edge_ratio = target.landmark >= 0 ? kFrameEdge : 0;
    picked.marker_edge_ratio = kFrameEdge;
    picked.marker_plate = pattern_picture(kMarkerPattern);
    if (target.landmark >= 0) picked.target_plate = pattern_picture(static_cast<std::uint32_t>(target.landmark));
    const auto marker = marker_corners(scene_.tool, start_tip_);
    tracking::Quad marker_px;
    for (std::size_t i = 0; i < 4; ++i) marker_px[i] = camera_.project(marker[i]);
    picked.marker = pick(marker_px);
    picked.scale = scale_of(target, random, pick);
    return picked;
  }

  servo::TruthSample truth(const servo::LoopRecord& record, std::size_t region) const override {
    const TargetOptions& target = target_of(region);
    const double t = record.frame.time_s;
    servo::TruthSample truth;
    const Eigen::Isometry3d pose = pose_at(target, t);
    truth.target = pose.translation() - camera_shift();
    truth.goal = goal_at(t) + pose_at(scene_.target, t).linear().col(2) * record.depth_m;
    truth.tip = scene_.loop.eye_in_hand ? Eigen::Vector3d(start_goal_ + tip_ - start_tip_) : tip_;
    truth.goal_px = camera_.project(*truth.goal - camera_shift());
    truth.tip_px = camera_.project(*truth.tip - camera_shift());
    truth.corners_px = region_at(target, t);
    if (scene_.loop.force.on()) truth.force_n = force_at(t);
    return truth;
  }

 private:
  bool next(tracking::Frame& frame) override {
    if (count_ >= scene_.frame_count()) return false;
    frame = tracking::Frame{};
    frame.sequence = count_;
    frame.time_s = static_cast<double>(count_) / scene_.camera.frame_rate_hz;
    robot_->advance_to(frame.time_s);
    tip_ = robot_->true_tip_camera();
    const ToolPose pose{tip_, robot_->true_turn_camera()};
    const ToolPose* tool = scene_.show_tool && !scene_.loop.eye_in_hand ? &pose : nullptr;
    endoscope_.move_view(camera_shift(), camera_shift());  // its light is carried with it
    endoscope_.render(frame.time_s, count_, frame.grey, tool);
    cover(camera_shift(), frame.time_s, frame.grey, stream_seed(scene_.seed, Stream::SWAB));
    if (right_) {
      const Eigen::Vector3d view = camera_shift() + baseline();
      right_->move_view(view, camera_shift());
      right_->render(frame.time_s, count_, frame.right, tool);
      cover(view, frame.time_s, frame.right, stream_seed(scene_.seed, Stream::RIGHT_SWAB));
    }
    ++count_;
    return true;
  }
  // The swabs of this time, as seen from a view.
  void cover(const Eigen::Vector3d& view, double t, cv::Mat& grey, std::uint64_t seed) const {
    const Eigen::Vector3d target = pose_at(scene_.target, t).translation() - view;
    const Eigen::Vector2d px = camera_.project(target);
    for (const OcclusionOptions& occlusion : scene_.occlusions)
      if (occlusion.covers(t))
        draw_swab(grey, {px.x(), px.y()}, occlusion.radius_m * camera_.fx / target.z(), scene_.picture.noise_grey,
                  seed + count_);
  }
  cv::Size size() const override { return {camera_.width, camera_.height}; }
  double frame_rate_hz() const override { return scene_.camera.frame_rate_hz; }
  std::optional<std::size_t> frame_count() const override { return scene_.frame_count(); }
  std::string description() const override { return scene_.title; }

  const TargetOptions& target_of(std::size_t region) const {
    return region == 0 ? scene_.target : scene_.more_targets.at(region - 1);
  }
  static std::size_t index_of(const TargetOptions& target) { return static_cast<std::size_t>(target.landmark); }

  Eigen::Isometry3d pose_at(const TargetOptions& target, double t) const {
    const HeartSurface& surface = endoscope_.surface();
    if (target.landmark >= 0) return surface.T_camera_landmark(index_of(target), t);
    const Eigen::Vector2d& point =
        targets_[&target == &scene_.target ? 0 : 1 + static_cast<std::size_t>(&target - scene_.more_targets.data())];
    return surface.T_camera_point(point.x(), point.y(), t);
  }

  // On a region without a landmark the target is the tissue that the first picture shows at the region's centre, which
  // on a curved surface is not the middle of its sides. By Newton's method on the ray.
  std::vector<Eigen::Vector2d> targets() const {
    std::vector<Eigen::Vector2d> points;
    for (std::size_t region = 0; region <= scene_.more_targets.size(); ++region) {
      const TargetOptions& target = target_of(region);
      Eigen::Vector2d& point = points.emplace_back(target.x_m, target.y_m);
      if (target.landmark >= 0) continue;
      const HeartSurface& surface = endoscope_.surface();
      const auto ray = [&](double x, double y) -> Eigen::Vector2d { return surface.point(x, y, 0).hnormalized(); };
      const double h = target.side_m / 2, x = target.x_m, y = target.y_m;
      tracking::Quad corners;
      const tracking::Quad sides = tracking::rectangle(-1, -1, 2, 2);
      for (std::size_t i = 0; i < 4; ++i) corners[i] = ray(x + h * sides[i].x(), y + h * sides[i].y());
      const Eigen::Vector2d centre = tracking::homography_between(sides, corners).col(2).hnormalized();
      for (int i = 0; i < 10; ++i) {
        constexpr double kStep_m = 1e-6;
        const Eigen::Vector2d now = ray(point.x(), point.y());
        Eigen::Matrix2d slope;
        slope << (ray(point.x() + kStep_m, point.y()) - now) / kStep_m,
            (ray(point.x(), point.y() + kStep_m) - now) / kStep_m;
        point += slope.inverse() * (centre - now);
      }
    }
    return points;
  }

  // A person measures the distance before the start, as well as the scene says; the loop gets the number.
  template <class Pick>
  tracking::ScaleSource scale_of(const TargetOptions& target, std::mt19937_64& random, const Pick& pick) const {
    const ScaleOptions& scale = scene_.depth;
    if (scale.source == "stereo") return right_ ? tracking::stereo_scale(*stereo(), scene_.stereo.matching) : nullptr;
    if (scale.source == "landmark") {
      const auto index = static_cast<std::size_t>(scale.landmark);
      if (index >= scene_.surface.landmarks.size()) return nullptr;
      const auto corners = endoscope_.surface().landmark_corners(index, 0);
      tracking::Quad px;
      for (std::size_t i = 0; i < 4; ++i) px[i] = camera_.project(corners[i]);
      return tracking::landmark_scale(camera_, pick(px), scene_.surface.landmarks[index].side_m, kFrameEdge,
                                      scene_.tracking.corner_sigma_px);
    }
    const double error = std::normal_distribution<double>(0, scale.sigma_m)(random);
    return tracking::known_scale({pose_at(target, 0).translation().z() + error, scale.sigma_m});
  }
  Eigen::Vector3d goal_at(double t) const {
    return pose_at(scene_.target, t) * (scene_.loop.offset_m + path_.position(t));
  }

  Eigen::Vector3d baseline() const { return {scene_.stereo.baseline_m, 0, 0}; }  // of the right view

  // Eye-in-hand the robot carries the camera: how far it has moved, in the first picture's camera frame.
  Eigen::Vector3d camera_shift() const {
    return scene_.loop.eye_in_hand ? Eigen::Vector3d(tip_ - start_tip_) : Eigen::Vector3d::Zero();
  }

  // Of the tissue on the tip. The tissue is the plane of the target's x and y, as near as the tip comes to it.
  double force_at(double t) const {
    constexpr double kHalf_s = 5e-4;
    const Eigen::Vector3d tip = robot_->true_tip_camera();
    const auto depth = [&](double time) { return (pose_at(scene_.target, time).inverse() * tip).z(); };
    const double now = depth(t), surface_rate = (depth(t + kHalf_s) - depth(t - kHalf_s)) / (2 * kHalf_s);
    const Eigen::Vector3d normal = pose_at(scene_.target, t).linear().col(2);
    return contact_force(scene_.tissue, now, surface_rate + normal.dot(robot_->true_velocity_camera()));
  }

  // Corners of the region in the picture.
  tracking::Quad region_at(const TargetOptions& target, double t) const {
    const HeartSurface& surface = endoscope_.surface();
    tracking::Quad quad;
    if (target.landmark >= 0) {
      const auto corners = surface.landmark_corners(index_of(target), t);
      for (std::size_t i = 0; i < 4; ++i) quad[i] = camera_.project(corners[i] - camera_shift());
      return quad;
    }
    const double h = target.side_m / 2, x = target.x_m, y = target.y_m;
    const tracking::Quad material = tracking::rectangle(x - h, y - h, 2 * h, 2 * h);
    for (std::size_t i = 0; i < 4; ++i)
      quad[i] = camera_.project(surface.point(material[i].x(), material[i].y(), t) - camera_shift());
    return quad;
  }

  Scene scene_;
  servo::SurgeonPath path_;
  tracking::Camera camera_;
  Endoscope endoscope_;
  std::vector<Eigen::Vector2d> targets_ = targets();  // of each region, on the surface's parameters (m)
  std::unique_ptr<Endoscope> right_;                  // null for one view
  std::unique_ptr<SimulatedRobot> robot_;
  FeelingRobot feeling_;
  Eigen::Vector3d tip_ = robot_->true_tip_camera();
  Eigen::Vector3d start_tip_ = tip_, start_goal_ = tip_;
  std::size_t count_ = 0;
};

}  // namespace

std::unique_ptr<Table> make_operating_table(const Scene& scene) { return std::make_unique<OperatingTable>(scene); }

std::unique_ptr<Table> make_table(const Scene& scene, std::unique_ptr<tracking::FrameSource> opened) {
  return scene.is_recorded() ? make_recorded_table(scene, std::move(opened)) : make_operating_table(scene);
}

}  // namespace heartservo::sim
