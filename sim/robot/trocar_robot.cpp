// A robot that carries the tool through a port in the body wall: a mechanical remote centre of rotation with pan and
// tilt, insertion and roll, as of laparoscopic arms. The loop commands the tip; its velocity goes to the joints through
// the inverse Jacobian at the joints' references. Each joint has its own second-order servo and limits. The tool turns
// as it moves (2.6 degrees for 5.5 mm at 120 mm), and its marker with it.
#include <Eigen/LU>
#include <cmath>
#include <random>

#include "sim/robot/cartesian_robot.hpp"
#include "sim/robot/registry.hpp"
#include "sim/robot/trocar_kinematics.hpp"

namespace heartservo::sim {

namespace {

constexpr double kSubstep_s = 2e-4;

class TrocarRobot final : public SimulatedRobot {
 public:
  explicit TrocarRobot(const RobotSetup& setup)
      : options_(setup.options),
        random_(setup.seed),
        calibration_(options_, setup.tip_camera, random_),
        kinematics_(calibration_.T_camera_base.inverse() * setup.tip_camera,
                    calibration_.T_camera_base.linear().transpose() * setup.tool_axis, options_.port_distance_m),
        R_start_(kinematics_.R_base_tool(joints_)),
        drive_(options_.max_speed, options_.max_acceleration) {
    // the worst way to be off: across the shaft
    const Eigen::Vector3d axis = kinematics_.R_base_port.col(2), any = random_direction(random_);
    body_port_ = kinematics_.port + options_.port_error_m * (any - any.dot(axis) * axis).normalized();
  }

  servo::ToolRobotData data() const override { return stated_data(options_, calibration_.stated); }
  void command(const servo::ToolCommand& command) override { drive_.command(command); }

  servo::ToolState read(double time_s) override {
    advance_to(time_s);
    servo::ToolState state;
    state.time_s = time_s_;
    // encoders sit on the joints: what they miss is worth the same at the tip
    const double l = kinematics_.length;
    Eigen::Vector4d seen = joints_;
    for (int i = 0; i < 4; ++i) seen[i] += options_.encoder_noise_m / (i == 2 ? 1 : l) * normal_(random_);
    state.tip = kinematics_.tip(seen);
    state.velocity = kinematics_.jacobian(joints_) * rates_.head<3>();
    state.R_start_tool = kinematics_.R_base_tool(seen) * R_start_.transpose();
    return state;
  }

  void advance_to(double time_s) override {
    while (time_s_ < time_s) {
      const double dt = std::min(kSubstep_s, time_s - time_s_);
      substep(dt);
      time_s_ = dt < kSubstep_s ? time_s : time_s_ + dt;
    }
  }

  Eigen::Vector3d true_tip_camera() const override { return calibration_.T_camera_base * kinematics_.tip(joints_); }
  Eigen::Vector3d true_velocity_camera() const override {
    return calibration_.T_camera_base.linear() * (kinematics_.jacobian(joints_) * rates_.head<3>());
  }
  Eigen::Matrix3d true_turn_camera() const override {
    const Eigen::Matrix3d& R = calibration_.T_camera_base.linear();
    return R * kinematics_.R_base_tool(joints_) * R_start_.transpose() * R.transpose();
  }
  double port_deviation_m() const override {
    const Eigen::Vector3d shaft = kinematics_.R_base_tool(joints_).col(2);
    return (body_port_ - kinematics_.port).cross(shaft).norm();
  }

 private:
  void substep(double dt) {
    const Eigen::Vector3d& v = drive_.step(time_s_, dt);
    references_.head<3>() += dt * (kinematics_.jacobian(references_).inverse() * v);
    for (int i = 0; i < 2; ++i)
      references_[i] = std::clamp(references_[i], -options_.max_pivot_rad, options_.max_pivot_rad);
    references_[2] = std::clamp(references_[2], -options_.max_insertion_m, options_.max_insertion_m);
    const double w = 2 * M_PI * options_.bandwidth_hz;
    const Eigen::Vector4d acceleration = w * w * (references_ - joints_) - 2 * options_.damping * w * rates_;
    rates_ += acceleration * dt;  // semi-implicit Euler
    joints_ += rates_ * dt;
  }

  RobotOptions options_;
  std::mt19937_64 random_;
  BaseCalibration calibration_;
  TrocarKinematics kinematics_;
  Eigen::Vector4d joints_ = Eigen::Vector4d::Zero(), rates_ = Eigen::Vector4d::Zero(),
                  references_ = Eigen::Vector4d::Zero();
  Eigen::Matrix3d R_start_;
  Eigen::Vector3d body_port_;
  TipDrive drive_;
  double time_s_ = 0;
  std::normal_distribution<double> normal_{0, 1};
};

}  // namespace

std::unique_ptr<SimulatedRobot> make_trocar_robot(const RobotSetup& setup) {
  return std::make_unique<TrocarRobot>(setup);
}

}  // namespace heartservo::sim
