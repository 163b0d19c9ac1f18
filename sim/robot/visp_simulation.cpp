// ViSP's free-flying vpSimulatorCamera as the robot, through the adapter that serves any vpRobot. It follows velocities
// at once; drives' limits, encoder noise and wrong calibration are those of the options, as for the other robots.
#include <visp3/core/vpException.h>
#include <visp3/robot/vpSimulatorCamera.h>

#include <cmath>
#include <random>

#include "servo/robot/visp_robot.hpp"
#include "sim/robot/base_calibration.hpp"
#include "sim/robot/cartesian_robot.hpp"
#include "sim/robot/registry.hpp"
#include "sim/robot/simulated_robot.hpp"

namespace heartservo::sim {

namespace {

constexpr double kSample_s = 5e-4;

class VispSimulation final : public SimulatedRobot {
 public:
  explicit VispSimulation(const RobotSetup& setup)
      : options_(setup.options),
        random_(setup.seed),
        calibration_(options_, setup.tip_camera, random_),
        adapter_(prepared(setup.tip_camera), adapter_options()) {}

  servo::ToolRobotData data() const override { return adapter_.data(); }
  void command(const servo::ToolCommand& command) override { adapter_.command(command); }
  servo::ToolState read(double time_s) override {
    advance_to(time_s);
    servo::ToolState state = adapter_.read(time_s);
    for (int i = 0; i < 3; ++i) state.tip[i] += options_.encoder_noise_m * normal_(random_);
    return state;
  }
  void advance_to(double time_s) override {
    while (time_s_ < time_s - 1e-9) {
      const double dt = std::min(kSample_s, time_s - time_s_);
      robot_.setSamplingTime(dt);  // each setVelocity() moves this robot on by one sampling time
      adapter_.send_due(time_s_);
      time_s_ += dt;
    }
  }
  Eigen::Vector3d true_tip_camera() const override {
    return calibration_.T_camera_base * (adapter_.pose() * adapter_.tip_m());
  }
  Eigen::Vector3d true_velocity_camera() const override {
    return calibration_.T_camera_base.linear() * adapter_.sent();
  }

 private:
  vpRobot& prepared(const Eigen::Vector3d& tip_camera) {
    const Eigen::Vector3d tip = calibration_.T_camera_base.inverse() * tip_camera;
    vpHomogeneousMatrix wMc;
    for (unsigned i = 0; i < 3; ++i) wMc[i][3] = tip(i);
    robot_.setPosition(wMc);
    robot_.setMaxTranslationVelocity(options_.max_speed);
    return robot_;
  }
  servo::VispRobotOptions adapter_options() const {
    servo::VispRobotOptions options;
    options.data = stated_data(options_, calibration_.stated);
    options.data.max_acceleration = options.data.bandwidth_hz = options.data.lag_s = 0;
    return options;
  }

  RobotOptions options_;
  std::mt19937_64 random_;
  BaseCalibration calibration_;
  vpSimulatorCamera robot_;
  servo::VispRobot adapter_;
  double time_s_ = 0;
  std::normal_distribution<double> normal_{0, 1};
};

}  // namespace

std::unique_ptr<SimulatedRobot> make_visp_simulation(const RobotSetup& setup) {
  return std::make_unique<VispSimulation>(setup);
}

}  // namespace heartservo::sim
