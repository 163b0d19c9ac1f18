// heartservo_pose_goals: the landmark's pose over many poses of the working volume, against exact truth. Three tables:
//
//   dense     landmark_dense on simulated pictures with grey noise, by tilt: errors in mm, the Cramer-Rao bound, errors
//             over bound, the estimator's own covariance (chi2 per degree of freedom), ms per pose
//   corners   the same noisy corners through eq. 6-8 and through IPPE with refinement: standard deviation of z, mm
//   side      frames on the wrong side of the planar ambiguity, each alone and with the frames before; a landmark that
//             sways by 4 degrees about its tilt, 125 Hz
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>

#include "tests/sim/dense_goals.hpp"
#include "tests/support/table2_camera.hpp"
#include "tests/tracking/landmark/swaying_square.hpp"
#include "tracking/landmark/square_pose.hpp"

namespace {

using namespace heartservo;

constexpr double kDegree = M_PI / 180;

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

void dense(int poses, double sigma_grey, double corner_sigma_px, int seed) {
  fmt::print("dense: {} poses a row, grey noise {}, corners to start with {} px\n{:>10}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}"
             "{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>8}\n",
             poses, sigma_grey, corner_sigma_px, "tilt", "z std", "z max", "z mean", "bound", "z/bound", "x std", "y std",
             "bound", "x/bound", "chi2 6", "chi2 3", "failed", "ms");
  for (const auto& [low, high] : {std::pair{0, 5}, {5, 15}, {15, 30}, {30, 45}, {0, 45}}) {
    std::mt19937_64 random(static_cast<std::uint64_t>(seed) * 1000 + low * 50 + high);
    const auto g = test::dense_goals(test::table2_camera(), random, poses, low * kDegree, high * kDegree, sigma_grey,
                                     corner_sigma_px, now_s);
    fmt::print("{:>10}{:>9.4f}{:>9.4f}{:>9.4f}{:>9.4f}{:>9.3f}{:>9.4f}{:>9.4f}{:>9.4f}{:>9.3f}{:>9.3f}{:>9.3f}{:>9}"
               "{:>8.2f}\n",
               fmt::format("{}-{}", low, high), 1e3 * g.z.std, 1e3 * g.z.max, 1e3 * g.z.mean, 1e3 * g.bound_z.rms,
               g.over_bound(2), 1e3 * g.x.std, 1e3 * g.y.std, 1e3 * g.bound_x.rms, g.over_bound(0),
               g.chi2_pose / (6 * poses), g.chi2_position / (3 * poses), g.invalid, g.ms);
    std::fflush(stdout);
  }
}

void corners(int poses, double sigma_px, int seed) {
  fmt::print("\ncorners: {} poses a row, {} px\n{:>6}{:>12}{:>12}{:>12}{:>12}{:>8}\n", poses, sigma_px, "tilt",
             "linear std", "linear max", "refined std", "refined max", "ratio");
  const tracking::Camera camera = test::table2_camera();
  for (const int tilt : {0, 5, 10, 20, 30, 45}) {
    std::mt19937_64 random(static_cast<std::uint64_t>(seed) * 1000 + tilt);
    std::vector<double> linear, refined;
    for (int k = 0; k < poses; ++k) {
      const auto truth = test::tilted_pose(random, tilt * kDegree, test::uniform(random, 0.045, 0.065));
      const auto seen = test::with_noise(random, tracking::project_square(camera, truth, test::SIDE), sigma_px);
      const double z = truth.translation().z();
      linear.push_back(
          tracking::linear_square_pose(test::normalised_corners(camera, seen), test::SIDE).translation().z() - z);
      const auto pose = tracking::refined_square_pose(camera, seen, test::SIDE, {sigma_px});
      refined.push_back(pose.solutions[pose.taken].T_camera_target.translation().z() - z);
    }
    const auto a = servo::spread_of(linear), b = servo::spread_of(refined);
    fmt::print("{:>6}{:>12.4f}{:>12.4f}{:>12.4f}{:>12.4f}{:>8.2f}\n", tilt, 1e3 * a.std, 1e3 * a.max, 1e3 * b.std,
               1e3 * b.max, a.std / b.std);
  }
}

void side(int sequences, int seed) {
  fmt::print("\nside: {} sequences of 250 frames a row\n{:>6}{:>8}{:>10}{:>12}{:>12}\n", sequences, "tilt", "px",
             "frames", "alone, %", "motion, %");
  for (const auto& [tilt, sigma] :
       {std::pair{5, 0.05}, {5, 0.1}, {10, 0.1}, {10, 0.2}, {10, 0.3}, {20, 0.3}, {20, 0.4}, {30, 0.4}}) {
    std::mt19937_64 random(static_cast<std::uint64_t>(seed) * 1000 + tilt);
    const auto wrong = test::count_wrong_side(random, tilt * kDegree, sigma, sequences);
    fmt::print("{:>6}{:>8}{:>10}{:>12.3f}{:>12.3f}\n", tilt, sigma, wrong.frames, 100.0 * wrong.without / wrong.frames,
               100.0 * wrong.with_motion / wrong.frames);
  }
}

}  // namespace

int main(int argc, char** argv) {
  int poses = 500, corner_poses = 20000, sequences = 100, seed = 1;
  double sigma_grey = 3, corner_sigma_px = 0.1;
  CLI::App app("the landmark's pose against exact truth and the Cramer-Rao bound");
  app.add_option("--poses", poses, "a row, dense")->capture_default_str();
  app.add_option("--noise-grey", sigma_grey)->capture_default_str();
  app.add_option("--corner-px", corner_sigma_px, "noise of the corners")->capture_default_str();
  app.add_option("--corner-poses", corner_poses, "a row")->capture_default_str();
  app.add_option("--sequences", sequences, "a row")->capture_default_str();
  app.add_option("--seed", seed)->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  dense(poses, sigma_grey, corner_sigma_px, seed);
  corners(corner_poses, corner_sigma_px, seed);
  side(sequences, seed);
  return 0;
}
