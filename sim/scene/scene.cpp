#include "sim/scene/scene.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <filesystem>

#include "servo/control/registry.hpp"
#include "tracking/camera/camera_file.hpp"
#include "tracking/frames/v4l2/camera_options.hpp"
#include "tracking/landmark/registry.hpp"
#include "tracking/planar/registry.hpp"
#include "tracking/settings/errors.hpp"
#include "tracking/settings/yaml_reader.hpp"

namespace heartservo::sim {

namespace {

// What region_depth and stereo_depth need of the scene.
void check_depth(const Scene& scene, std::vector<std::string>& problems) {
  for (const auto& problem : scene.depth.assumed.validate()) problems.push_back("depth." + problem);
  for (const auto& problem : scene.stereo.matching.validate()) problems.push_back("stereo." + problem);
  const bool two_views = scene.is_recorded() ? !scene.recording.right.empty() : scene.stereo.baseline_m > 0;
  const bool region = scene.engines.estimator == "region_depth", stereo = scene.engines.estimator == "stereo_depth";
  const char* missing = scene.is_recorded() ? "recording.right" : "stereo.baseline_m above 0";
  if (stereo && !two_views) problems.push_back(fmt::format("engines.estimator: stereo_depth needs {}", missing));
  if (region && scene.depth.source == "stereo" && !two_views)
    problems.push_back(fmt::format("depth.source: stereo needs {}", missing));
  if (region && scene.depth.source == "landmark" &&
      (scene.is_recorded() || scene.depth.landmark >= static_cast<int>(scene.surface.landmarks.size())))
    problems.push_back(fmt::format(
        "depth.landmark is {} but {}", scene.depth.landmark,
        scene.is_recorded() ? std::string("recorded frames have no landmark of known size")
                            : fmt::format("surface.landmarks has {} entries", scene.surface.landmarks.size())));
  if (!scene.recording.right.empty() && scene.camera.calibration.empty())
    problems.emplace_back("recording.right needs camera.calibration, a stereo file");
}

}  // namespace

void EngineOptions::fields(FieldVisitor& v) {
  v.choice({"tracker", "", "follows the region; the tool's marker, a rigid plate, is followed by esm"}, tracker, tracking::trackers().names());
  v.choice({"estimator", "", "pixels to metres"}, estimator, tracking::estimators().names());
  v.choice({"predictor", "", "foresees the goal"}, predictor, servo::predictors().names());
  v.choice({"controller", "", "control law"}, controller, servo::control_laws().names());
}

void Scene::fields(FieldVisitor& v) {
  v.field({"title", "", "one line for people"}, title);
  v.field({"seed", "", "of every random draw: the same seed gives the same numbers", 0, 2e9}, seed);
  v.field({"duration_s", "s", "of a simulated run", 1e-4, 1e5}, duration_s);
  v.field({"settle_s", "s", "frames before this are not scored", 0, 1e4}, settle_s);
  v.group("camera", "the endoscope's camera", camera);
  v.group("recording", "frames from disk instead of the simulated heart", recording);
  v.group("motion", "how the simulated heart moves", motion);
  v.group("ecg", "an ECG beside the frames, for predictors that know the heartbeat", ecg);
  v.group("surface", "shape, deformation and landmarks of the simulated heart", surface);
  v.group("target", "what the loop follows on the simulated heart", target);
  v.list("more_targets", "further regions that the command track follows", more_targets);
  v.group("depth", "depth of a region without landmark, for engines.estimator: region_depth", depth);
  v.group("stereo", "the second view of a stereo endoscope", stereo);
  v.group("picture", "light, lens, sensor and texture of the simulated picture", picture);
  v.group("tool", "the tool as it looks in the picture", tool);
  v.group("robot", "the robot that carries the tool", robot);
  v.group("tissue", "what the tip feels when it presses", tissue);
  v.list("occlusions", "swabs that cover the target for a while", occlusions);
  v.group("engines", "stages of the loop, by name", engines);
  v.group("tracking", "options of the trackers", tracking);
  v.group("loop", "latency, surgeon's offset, options of the stages", loop);
  v.group("depth_rail", "the paper's experiment on depth (section 4.1), run by `heartservo track SCENE`", depth_rail);
}

std::size_t Scene::frame_count() const {
  return static_cast<std::size_t>(std::lround(duration_s * camera.frame_rate_hz));
}

std::size_t Scene::region_count() const {
  return is_recorded() ? std::max<std::size_t>(1, recording.roi.size() / 4) : 1 + more_targets.size();
}

std::vector<std::string> Scene::validate() const {
  std::vector<std::string> problems;
  const auto add = [&](const std::vector<std::string>& more) {
    problems.insert(problems.end(), more.begin(), more.end());
  };
  if (!is_recorded() && camera.frame_rate_hz < 1) problems.emplace_back("camera.frame_rate_hz is below 1 Hz");
  if (settle_s >= duration_s && !is_recorded())
    problems.push_back(
        fmt::format("settle_s ({} s) leaves nothing of duration_s ({} s) to score", settle_s, duration_s));
  if (frame_count() < 1 && !is_recorded()) problems.emplace_back("duration_s is shorter than a frame");
  if (target.landmark >= static_cast<int>(surface.landmarks.size()) && !is_recorded())
    problems.push_back(fmt::format("target.landmark is {} but surface.landmarks has {} entries", target.landmark,
                                   surface.landmarks.size()));
  for (std::size_t i = 0; i < more_targets.size() && !is_recorded(); ++i)
    if (more_targets[i].landmark >= static_cast<int>(surface.landmarks.size()))
      problems.push_back(fmt::format("more_targets[{}].landmark is {} but surface.landmarks has {} entries", i,
                                     more_targets[i].landmark, surface.landmarks.size()));
  if (recording.roi.size() % 4 != 0) problems.emplace_back("recording.roi must be x, y, width, height");
  for (std::size_t i = 0; i + 3 < recording.roi.size(); i += 4)
    if (!(recording.roi[i + 2] > 0 && recording.roi[i + 3] > 0))
      problems.emplace_back("recording.roi needs a width and a height above 0");
  check_depth(*this, problems);
  if (!recording.point.empty() && recording.reference.empty())
    problems.emplace_back("recording.point names a point of recording.reference, which is not given");
  if (tracking.uncertain_quality > tracking.ok_quality)
    problems.emplace_back("tracking.uncertain_quality is above tracking.ok_quality");
  if (!(loop.latency.total_s() < 2)) problems.emplace_back("loop.latency adds up to 2 s or more");
  if (tool.marker_side_m <= 0 && loop.tip.use_marker)
    problems.emplace_back("loop.tip.use_marker needs tool.marker_side_m above 0");
  if (is_recorded() && engines.estimator.rfind("landmark", 0) == 0)
    problems.emplace_back(
        "recorded frames have no landmark of known size: engines.estimator must be assumed_depth, region_depth or "
        "stereo_depth");
  if (is_recorded() && (loop.force.on() || loop.eye_in_hand))
    problems.emplace_back(
        "loop.force and loop.eye_in_hand need a simulated heart: recorded frames cannot be touched or moved");
  if (loop.eye_in_hand && loop.tip.use_marker)
    problems.emplace_back("loop.eye_in_hand shows no tool: loop.tip.use_marker must be false");
  if (is_recorded() && loop.path.type != "hold")
    problems.emplace_back(
        "loop.path needs the heart's orientation, which recorded frames do not tell: it must be hold");
  if (is_recorded() && ecg.source == "simulated")
    problems.emplace_back("ecg.source: recorded frames have no simulated heart; give a recorded ECG");
  if (!depth_rail.tilts_rad.empty() && (is_recorded() || motion.profile != "rail" || target.landmark < 0))
    problems.emplace_back("depth_rail.tilts_rad needs motion.profile rail and a landmark as target");
  add(motion.validate());
  add(ecg.validate());
  add(surface.validate());
  add(picture.validate());
  add(tool.validate());
  add(loop.validate());
  return problems;
}

void require_valid(const Scene& scene, const std::string& where) {
  const auto problems = scene.validate();
  if (!problems.empty()) throw ConfigError(fmt::format("{}: {}", where, fmt::join(problems, "; ")));
}

Scene load_scene(const std::string& file) {
  Scene scene;
  read_fields(load_yaml(file), file, scene);
  const auto folder = std::filesystem::path(file).parent_path();
  scene.folder = folder.empty() ? "." : folder.string();
  require_valid(scene, file);
  return scene;
}

std::string resolve(const Scene& scene, const std::string& path) {
  if (tracking::v4l2::is_camera(path)) return path;
  const std::filesystem::path p(path);
  return p.is_absolute() ? path : (std::filesystem::path(scene.folder) / p).lexically_normal().string();
}

tracking::Camera camera_of(const Scene& scene, int width, int height) {
  if (!scene.camera.calibration.empty()) {
    const auto camera = tracking::read_camera(resolve(scene, scene.camera.calibration));
    if (width > 0 && (camera.width != width || camera.height != height))
      throw ConfigError(fmt::format("{}: made for {} x {} px, but the pictures have {} x {}", scene.camera.calibration,
                                    camera.width, camera.height, width, height));
    return camera;
  }
  return tracking::Camera::pinhole(width > 0 ? width : 512, height > 0 ? height : 512, scene.camera.field_of_view_rad);
}

}  // namespace heartservo::sim
