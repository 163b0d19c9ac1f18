#pragma once
#include "servo/loop/loop.hpp"
#include "tracking/landmark/registry.hpp"

namespace heartservo::sim {

struct Scene;
class Table;

/// The loop's stages as the scene names them, fitted to the table's camera and plates. Throws ConfigError.
servo::LoopStages make_stages(const Scene& scene, const Table& table);

/// What an estimator of the region (Scene::region_count()) is made from.
tracking::EstimatorOptions estimator_options(const Scene& scene, const Table& table, std::size_t region = 0);

/// The scene's loop options with what only the table knows: frame rate and offset.
servo::LoopOptions loop_options(const Scene& scene, Table& table);

}  // namespace heartservo::sim
