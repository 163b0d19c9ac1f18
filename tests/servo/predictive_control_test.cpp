// The parts of gpc and mpc, and both laws on a simulated robot.
#include <gtest/gtest.h>

#include <cmath>

#include "servo/control/feed_forward.hpp"
#include "servo/control/limited_least_squares.hpp"
#include "servo/control/plant_response.hpp"
#include "servo/control/registry.hpp"
#include "servo/control/repeated_path.hpp"
#include "tests/support/random.hpp"

namespace heartservo::servo {
namespace {

constexpr double kPeriod = 0.008;

ToolRobotData robot_of(double bandwidth_hz = 25) {
  ToolRobotData data;
  data.bandwidth_hz = bandwidth_hz;
  data.lag_s = 2 * 0.7 / (2 * M_PI * bandwidth_hz);
  return data;
}

TEST(PlantResponse, AgreesWithTheRobotModelOnRandomVelocities) {
  auto random = test::seeded();
  const PlantResponse plant(robot_of(), kPeriod);
  RobotModel model(robot_of());
  const auto draw = [&] { return Eigen::Vector3d(test::normal(random), test::normal(random), test::normal(random)); };
  for (int k = 0; k < 5; ++k) model.command({k * kPeriod, draw()});
  model.advance_to(5 * kPeriod);
  const RobotState begin = model.state();
  Eigen::MatrixXd U(8, 3);
  for (int j = 0; j < 8; ++j) {
    U.row(j) = draw().transpose();
    model.command({(5 + j) * kPeriod, U.row(j).transpose()});
  }
  const Eigen::MatrixXd path = plant.free(begin).topRows(8) + plant.matrix(8, 8) * U;
  for (int k = 1; k <= 8; ++k)
    EXPECT_LT((model.at((5 + k) * kPeriod).tip - path.row(k - 1).transpose()).norm(), 1e-6) << k;
}

double cost(const Eigen::MatrixXd& G, const Eigen::MatrixXd& U, const Eigen::MatrixXd& D, double smooth,
            const Eigen::Vector3d& last) {
  double sum = (G * U - D).squaredNorm() + smooth * (U.row(0) - last.transpose()).squaredNorm();
  for (int j = 1; j < U.rows(); ++j) sum += smooth * (U.row(j) - U.row(j - 1)).squaredNorm();
  return sum;
}

TEST(LimitedLeastSquares, WithoutActiveLimitsItIsLeastSquares) {
  auto random = test::seeded();
  const PlantResponse plant(robot_of(), kPeriod);
  const Eigen::MatrixXd G = plant.matrix(6, 6);
  LimitedLeastSquares problem(G, 1e-6, 1e6, 1e6);
  const Eigen::Vector3d last(0.01, 0, -0.02);
  Eigen::MatrixXd D(6, 3);
  for (int i = 0; i < 18; ++i) D(i / 3, i % 3) = test::normal(random, 1e-3);
  const Eigen::MatrixXd U = problem.solve(D, last);
  EXPECT_EQ(problem.iterations(), 0);
  const double least = cost(G, U, D, 1e-6, last);
  for (int i = 0; i < 200; ++i) {
    Eigen::MatrixXd other = U;
    for (int k = 0; k < 18; ++k) other(k / 3, k % 3) += test::normal(random, 1e-3);
    EXPECT_GT(cost(G, other, D, 1e-6, last), least);
  }
}

TEST(LimitedLeastSquares, WithActiveLimitsItHoldsThemAndNoFeasibleNeighbourIsBetter) {
  auto random = test::seeded();
  const PlantResponse plant(robot_of(), kPeriod);
  const Eigen::MatrixXd G = plant.matrix(6, 6);
  const double max_speed = 0.1, max_change = 0.03, smooth = 2e-6;
  LimitedLeastSquares problem(G, smooth, max_speed, max_change);
  const auto feasible = [&](const Eigen::MatrixXd& U, const Eigen::Vector3d& last) {
    bool good = true;
    for (int j = 0; j < 6; ++j) {
      const Eigen::Vector3d before = j == 0 ? last : Eigen::Vector3d(U.row(j - 1).transpose());
      good &= U.row(j).norm() <= max_speed && (U.row(j).transpose() - before).norm() <= max_change;
    }
    return good;
  };
  for (int round = 0; round < 20; ++round) {
    Eigen::MatrixXd D(6, 3);
    const Eigen::Vector3d last(test::normal(random, 0.03), test::normal(random, 0.03), 0);
    const Eigen::Vector3d rate(test::normal(random, 0.2), test::normal(random, 0.2), test::normal(random, 0.2));
    for (int k = 0; k < 6; ++k) D.row(k) = (k + 1) * kPeriod * rate.transpose();
    const Eigen::MatrixXd U = problem.solve(D, last);
    EXPECT_LT(problem.violation(), 1e-5);
    const double least = cost(G, U, D, smooth, last);
    int tried = 0;
    for (int i = 0; i < 4000; ++i) {
      Eigen::MatrixXd other = U;
      const double size = std::pow(10, -2 - 3 * test::uniform(random, 0, 1));
      for (int k = 0; k < 18; ++k) other(k / 3, k % 3) += test::normal(random, size);
      other *= 1 - test::uniform(random, 0, 0.02);
      if (!feasible(other, last)) continue;
      ++tried;
      EXPECT_GT(cost(G, other, D, smooth, last), least * (1 - 1e-4) - 1e-12);
    }
    EXPECT_GT(tried, 5);
  }
}

TEST(RepeatedPath, FindsThePeriodOfHeartAndBreathAndForeseesThem) {
  RepeatedPath path(kPeriod);
  const auto at = [](double t) {
    return Eigen::Vector3d(2e-3 * std::sin(2 * M_PI * 1.19 * t) + 1e-3 * std::sin(2 * M_PI * 2.38 * t + 1),
                           1e-3 * std::cos(2 * M_PI * 1.19 * t), 3e-3 * std::sin(2 * M_PI * t / 3));
  };
  double worst = 0;
  for (int k = 0; k < 1500; ++k) {
    path.add(at(k * kPeriod));
    if (k < 600) continue;
    ASSERT_TRUE(path.known());
    EXPECT_NEAR(path.period_s(), 1 / 1.19, 0.02);
    worst = std::max(worst, (path.at(0.048) - at(k * kPeriod + 0.048)).norm());
  }
  EXPECT_LT(worst, 7e-4);  // what the breath adds to one beat ago; the motion itself makes up to 1.7 mm in this time
}

TEST(RepeatedPath, WithoutRepetitionItKnowsNothing) {
  RepeatedPath path(kPeriod);
  for (int k = 0; k < 300; ++k) path.add(Eigen::Vector3d(1e-3 * k, 0, 0.05));
  EXPECT_FALSE(path.known());
  EXPECT_EQ(path.at(0.03), Eigen::Vector3d(0.299, 0, 0.05));
}

// A loop without camera: perfect measurement of a moving goal, `latency` of dead time, foreseen exactly.
double residual_rms(const std::string& law_name, double frequency_hz, ControlSetup setup, double latency = 0.024,
                    double true_bandwidth_hz = 25, double amplitude = 2e-3) {
  const auto law = control_laws().make(law_name, setup);
  const auto goal = [&](double t) {
    Prediction p;
    p.valid = true;
    p.time_s = t;
    const double w = 2 * M_PI * frequency_hz;
    p.position = Eigen::Vector3d(0, amplitude * std::sin(w * t), 0.055);
    p.velocity = Eigen::Vector3d(0, amplitude * w * std::cos(w * t), 0);
    return p;
  };
  RobotModel truth(robot_of(true_bandwidth_hz)), model(setup.robot);
  const Eigen::Vector3d start(0, 0, 0.055);
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  const RobotLag lag(setup.robot);
  double sum = 0;
  int n = 0;
  for (int k = 0; k < 750; ++k) {
    ControlState s;
    s.time_s = k * kPeriod;
    s.acts_at_s = s.time_s + latency;
    s.period_s = kPeriod;
    truth.advance_to(s.time_s);
    model.advance_to(s.time_s);
    const RobotState now = model.state(), then = model.at(s.acts_at_s);
    s.tip_now = start + truth.state().tip;
    s.goal_now = goal(s.time_s).position;
    s.goal_then = goal(s.acts_at_s + setup.robot.lag_s);
    s.last_velocity = last;
    s.robot = {s.tip_now + then.reference - now.tip, then.reference_velocity, s.tip_now + then.tip - now.tip,
               then.tip_velocity};
    for (int j = -1; j <= law->horizon(); ++j)
      s.goals[static_cast<std::size_t>(j + 1)] = goal(s.acts_at_s + j * kPeriod);
    last = law->velocity(s);
    if (law->wants_feed_forward()) last += feed_forward(s, lag);
    truth.command({s.acts_at_s, last});
    model.command({s.acts_at_s, last});
    if (k > 500) sum += (s.tip_now - s.goal_now).squaredNorm(), ++n;
  }
  return std::sqrt(sum / n) / (amplitude / std::sqrt(2));
}

ControlSetup setup_of(double stated_bandwidth_hz = 25) {
  ControlSetup setup;
  setup.robot = robot_of(stated_bandwidth_hz);
  return setup;
}

TEST(ControlLaws, WithAPerfectPredictionTheRobotsLagIsTakenOut) {
  for (const char* law : {"ibvs_feedforward", "mpc"})
    for (const double f : {1.0, 3.0, 5.0}) EXPECT_LT(residual_rms(law, f, setup_of()), 0.03) << law << " " << f;
  EXPECT_GT(residual_rms("ibvs", 1.0, setup_of()), 0.3);
}

TEST(ControlLaws, GpcForeseesARegularBeatByItself) {
  EXPECT_LT(residual_rms("gpc", 1.2, setup_of()), 0.03);
}

TEST(ControlLaws, StayStableWhenTheRobotIsNotAsStated) {
  for (const char* law : {"ibvs_feedforward", "mpc"})
    for (const double error : {0.8, 1.25}) {
      const double left = residual_rms(law, 2.4, setup_of(25 * error));
      EXPECT_LT(left, 0.15) << law << " " << error;
    }
}

TEST(ControlLaws, MpcHoldsTheLimitsItIsGiven) {
  ControlSetup setup = setup_of();
  setup.max_speed = 0.03;
  setup.max_acceleration = 1;
  const auto law = control_laws().make("mpc", setup);
  ControlState s;
  s.period_s = kPeriod;
  s.robot.reference = s.robot.tip = {0, 0, 0.05};
  s.last_velocity = {0.02, 0, 0};
  for (auto& g : s.goals) g.position = {0.02, 0.03, 0.05};
  const Eigen::Vector3d v = law->velocity(s);
  EXPECT_LE(v.norm(), 0.03 + 1e-5);
  EXPECT_LE((v - s.last_velocity).norm(), 0.008 + 1e-5);
  EXPECT_GT((v - s.last_velocity).norm(), 0.0079);
}

TEST(ControlLaws, ANotFiniteGoalGivesNoFiniteVelocity) {
  for (const auto& name : control_laws().names()) {
    const auto law = control_laws().make(name, setup_of());
    ControlState s;
    s.period_s = kPeriod;
    s.tip_now = s.robot.reference = s.robot.tip = {0, 0, 0.05};
    s.last_velocity.setZero();
    s.goal_now = s.goal_then.position = {0, NAN, 0.05};
    for (auto& g : s.goals) g = s.goal_then;
    EXPECT_FALSE(law->velocity(s).allFinite()) << name;
  }
}

}  // namespace
}  // namespace heartservo::servo
