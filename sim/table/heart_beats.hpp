#pragma once
// The beats of a scene's heart and its ECG, from files or drawn.
#include <cstdint>
#include <memory>
#include <vector>

#include "servo/ecg/ecg_monitor.hpp"
#include "sim/heart/heart_motion.hpp"

namespace heartservo::sim {

struct Scene;

/// The motion of the scene's heart: by drawn beats, or by those of motion.beats, or by the labels of a recorded ECG.
/// Throws InputError, ConfigError (no labels, or too short for the run).
HeartMotion heart_motion(const Scene& scene, std::uint64_t seed);

/// The scene's ECG; null for none. `beats`: the heart's, for a simulated one.
std::unique_ptr<servo::EcgSource> heart_ecg(const Scene& scene, const std::vector<double>& beats, std::uint64_t seed);

}  // namespace heartservo::sim
