#pragma once
#include "servo/control/registry.hpp"
#include "servo/loop/loop.hpp"
#include "tracking/landmark/registry.hpp"

namespace heartservo::sim {

struct Scene;
class Table;

/// The loop's stages as the scene names them, fitted to the table's camera and plates. Throws ConfigError.
servo::LoopStages make_stages(const Scene& scene, Table& table);

/// What the control laws are made from.
servo::ControlSetup control_setup(const Scene& scene, Table& table);

/// A recorded hand: CSV with time_s, x_m, y_m, z_m. Throws InputError with file and line.
std::vector<servo::PathPoint> read_path(const std::string& file);

/// The path that the scene asks for. Throws InputError.
servo::SurgeonPath surgeon_path(const Scene& scene);

/// What an estimator of the region (Scene::region_count()) is made from.
tracking::EstimatorOptions estimator_options(const Scene& scene, const Table& table, std::size_t region = 0);

/// The scene's loop options with what only the table knows: frame rate and offset.
servo::LoopOptions loop_options(const Scene& scene, Table& table);

}  // namespace heartservo::sim
