// heartservo_control_goals: the closed loop without pictures, to see what control and prediction leave by themselves.
// Target and marker are measured with the noise that tracking has on pig_2007 (0.006, 0.006, 0.025 mm); everything else
// is the scene's: heart, robot, latency, guard. The predictor `oracle` knows the future, so that its rows show the
// control law alone. Run by hand.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <random>

#include "servo/control/registry.hpp"
#include "servo/loop/loop.hpp"
#include "servo/loop/score.hpp"
#include "sim/heart/heart_surface.hpp"
#include "sim/robot/registry.hpp"
#include "sim/scene/scene.hpp"
#include "sim/table/heart_beats.hpp"
#include "sim/table/stages.hpp"
#include "tracking/settings/errors.hpp"

using namespace heartservo;

namespace {

struct Truth {
  sim::Scene scene;
  sim::HeartSurface surface;
  servo::SurgeonPath path;
  explicit Truth(const sim::Scene& s)
      : scene(s),
        surface(s.surface, sim::heart_motion(s, static_cast<std::uint64_t>(s.seed) * 1000003ULL + 1),
                static_cast<std::uint64_t>(s.seed) * 1000003ULL + 2),
        path(sim::surgeon_path(s)) {}
  Eigen::Isometry3d pose(double t) const { return surface.T_camera_landmark(0, t); }
  Eigen::Vector3d carried(double t) const { return pose(t) * scene.loop.offset_m; }
  Eigen::Vector3d goal(double t) const { return pose(t) * (scene.loop.offset_m + path.position(t)); }
};

struct Oracle final : servo::MotionPredictor {
  const Truth* truth;
  explicit Oracle(const Truth* t) : truth(t) {}
  void observe(const servo::MotionSample&) override {}
  servo::Prediction predict(double t) const override {
    servo::Prediction p;
    p.valid = true;
    p.time_s = t;
    p.position = truth->carried(t);
    p.velocity = (truth->carried(t + 1e-3) - truth->carried(t - 1e-3)) / 2e-3;
    return p;
  }
};

struct Clock final : tracking::FrameSource {
  std::size_t count, at = 0;
  double rate;
  sim::SimulatedRobot& robot;
  Clock(std::size_t n, double r, sim::SimulatedRobot& bot) : count(n), rate(r), robot(bot) {}
  bool next(tracking::Frame& frame) override {
    if (at == count) return false;
    frame = tracking::Frame{};
    frame.time_s = static_cast<double>(at) / rate;
    frame.sequence = at++;
    robot.advance_to(frame.time_s);
    return true;
  }
  cv::Size size() const override { return {1, 1}; }
  double frame_rate_hz() const override { return rate; }
  std::optional<std::size_t> frame_count() const override { return count; }
  std::string description() const override { return "clock"; }
};

struct Blind final : tracking::TargetTracker {
  double lost_from = 1e9, lost_to = 1e9;
  std::string start(const tracking::Frame&, const tracking::Quad&) override { return ""; }
  tracking::Track track(const tracking::Frame& frame) override {
    tracking::Track t;
    t.time_s = frame.time_s;
    t.state =
        frame.time_s >= lost_from && frame.time_s < lost_to ? tracking::TrackState::LOST : tracking::TrackState::OK;
    return t;
  }
  Eigen::Vector2d carry(const Eigen::Vector2d& p) const override { return p; }
  void mark_left_out(cv::Mat&) override {}
};

struct Measure final : tracking::TargetEstimator {
  std::function<Eigen::Isometry3d(double)> pose;
  std::mt19937_64 random;
  std::normal_distribution<double> normal;
  Measure(std::function<Eigen::Isometry3d(double)> p, std::uint64_t seed) : pose(std::move(p)), random(seed) {}
  tracking::TargetState estimate(const tracking::Track& track) override {
    tracking::TargetState s;
    s.time_s = track.time_s;
    s.state = track.state;
    s.T_camera_target = pose(track.time_s);
    const Eigen::Vector3d sigma(6e-6, 6e-6, 2.5e-5);
    for (int i = 0; i < 3; ++i) s.T_camera_target.translation()[i] += sigma[i] * normal(random);
    s.position_covariance = sigma.cwiseAbs2().asDiagonal();
    return s;
  }
};

servo::ScoreSummary run(const sim::Scene& scene, const std::string& predictor, const std::string& law, double lost_s) {
  const Truth truth(scene);
  sim::RobotSetup setup{scene.robot, truth.goal(0) + scene.robot.start_error_m, scene.tool.direction.normalized(),
                        static_cast<std::uint64_t>(scene.seed) * 1000003ULL + 4};
  const auto robot = sim::make_robot(setup);
  Clock clock(scene.frame_count(), scene.camera.frame_rate_hz, *robot);
  servo::LoopStages stages;
  auto tracker = std::make_unique<Blind>();
  if (lost_s > 0) tracker->lost_from = 0.7 * scene.duration_s, tracker->lost_to = tracker->lost_from + lost_s;
  stages.target_tracker = std::move(tracker);
  stages.marker_tracker = std::make_unique<Blind>();
  stages.target_estimator = std::make_unique<Measure>([&](double t) { return truth.pose(t); }, scene.seed);
  const Eigen::Vector3d arm = scene.tool.marker_offset_m;
  stages.marker_estimator = std::make_unique<Measure>(
      [&](double) {
        Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
        T.translation() = robot->true_tip_camera() + robot->true_turn_camera() * arm;
        return T;
      },
      scene.seed + 77);
  if (predictor == "oracle")
    stages.predictor = std::make_unique<Oracle>(&truth);
  else
    stages.predictor = servo::predictors().make(predictor, scene.loop.prediction);
  servo::ControlSetup control;
  control.options = scene.loop.control;
  control.robot = robot->data();
  control.period_s = 1 / clock.rate;
  control.max_speed = scene.loop.guard.max_speed;
  control.max_acceleration = scene.loop.guard.max_acceleration;
  if (auto ecg = sim::heart_ecg(scene, truth.surface.motion().beats(),
                                static_cast<std::uint64_t>(scene.seed) * 1000003ULL + 7))
    stages.ecg = std::make_unique<servo::EcgMonitor>(std::move(ecg));
  stages.control_law = servo::control_laws().make(law, control);
  servo::LoopOptions options = scene.loop;
  options.frame_rate_hz = clock.rate;
  options.tool_axis = setup.tool_axis;
  servo::Loop loop(clock, *robot, std::move(stages), options, -arm, [] { return 0.0; });
  const tracking::Quad region = tracking::rectangle(0, 0, 1, 1);
  loop.start(region, region);
  servo::Score score(scene.settle_s, control.period_s);
  servo::LoopRecord record;
  while (loop.step(record)) {
    servo::TruthSample sample;
    sample.goal = truth.goal(record.frame.time_s);
    sample.tip = robot->true_tip_camera();
    score.add(record, sample);
  }
  if (!loop.stop_reason().empty()) fmt::print("  stopped: {}\n", loop.stop_reason());
  return score.summary();
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("the closed loop without pictures");
  std::string file;
  std::vector<std::string> laws = servo::control_laws().names(), predictors{"oracle", "constant_acceleration"};
  std::vector<int> seeds{1};
  std::string robot;
  double seconds = 30, settle = 8, dynamics_error = 0, lost_s = 0, smoothing = -1, gain = -1;
  int horizon = 0;
  app.add_option("scene", file)->required();
  app.add_option("--law", laws)->delimiter(',');
  app.add_option("--predictor", predictors)->delimiter(',');
  app.add_option("--seed", seeds)->delimiter(',');
  app.add_option("--robot", robot);
  app.add_option("--seconds", seconds);
  app.add_option("--settle-s", settle);
  app.add_option("--dynamics-error", dynamics_error);
  app.add_option("--lost-s", lost_s);
  app.add_option("--smoothing", smoothing);
  app.add_option("--horizon", horizon);
  app.add_option("--gain", gain);
  CLI11_PARSE(app, argc, argv);
  try {
    sim::Scene scene = sim::load_scene(file);
    scene.duration_s = seconds;
    scene.settle_s = settle;
    scene.robot.dynamics_error = dynamics_error;
    if (!robot.empty()) scene.robot.type = robot;
    if (smoothing >= 0) scene.loop.control.smoothing = smoothing;
    if (horizon > 0) scene.loop.control.horizon = horizon;
    if (gain > 0) scene.loop.control.gain_feedforward = gain;
    for (const auto& predictor : predictors)
      for (const auto& law : laws)
        for (const int seed : seeds) {
          scene.seed = seed;
          const auto s = run(scene, predictor, law, lost_s);
          fmt::print(
              "{:<22} {:<18} seed {}: RMS {:.4f} mm (x {:.4f} y {:.4f} z {:.4f}), 95 % {:.3f}, max {:.3f}, "
              "cancelled {:.2f} %\n",
              predictor, law, seed, 1e3 * s.residual.rms, 1e3 * s.residual_axis_rms.x(), 1e3 * s.residual_axis_rms.y(),
              1e3 * s.residual_axis_rms.z(), 1e3 * s.residual.p95, 1e3 * s.residual.max, s.reduction_percent);
        }
  } catch (const std::exception& e) {
    fmt::print(stderr, "heartservo_control_goals: {}\n", e.what());
    return 2;
  }
}
