// heartservo scene: checks scenes without running them, and writes what there is to know about their keys.
#include <fmt/format.h>

#include "embedded.hpp"
#include "sim/scene/scene.hpp"
#include "tools/command.hpp"
#include "tools/shipped.hpp"
#include "tracking/settings/document.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tools {

namespace {

struct SceneOptions {
  std::vector<std::string> files;
  std::string keys;
};

// The camera file too: it is the other half of what a scene says.
void check(const std::string& file) {
  const sim::Scene scene = sim::load_scene(shipped(file));
  if (!scene.camera.calibration.empty()) sim::camera_of(scene, 0, 0);
  fmt::print("{}: {}\n", file, scene.title.empty() ? "good" : scene.title);
}

int run_scene(const SceneOptions& o) {
  if (o.files.empty() == o.keys.empty()) throw ConfigError("give scene files to check, or --keys markdown or schema");
  for (const auto& file : o.files) check(file);
  const sim::Scene defaults;
  if (o.keys == "markdown")
    fmt::print(
        "<!-- Made by 'heartservo scene --keys markdown'; the text comes from tools/scene_introduction.md. -->\n"
        "{}{}",
        embedded::scene_introduction(), to_markdown(defaults));
  if (o.keys == "schema") fmt::print("{}", to_json_schema(defaults, "A scene of heartservo"));
  return DONE;
}

}  // namespace

Command add_scene_command(CLI::App& program) {
  auto options = std::make_shared<SceneOptions>();
  SceneOptions& o = *options;
  CLI::App* app = program.add_subcommand("scene", "check scenes; document their keys");
  app->add_option("files", o.files, "scenes (.yaml) to check")->type_name("FILE");
  app->add_option("--keys", o.keys, "print every key: as scenes/README.md or as scenes/scene.schema.json")
      ->check(one_of({"markdown", "schema"}));
  app->footer(
      "Examples:\n  heartservo scene scenes/pig_2007.yaml\n"
      "  heartservo scene --keys schema > scenes/scene.schema.json");
  return {app, [options] { return run_scene(*options); }};
}

}  // namespace heartservo::tools
