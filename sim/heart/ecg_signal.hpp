#pragma once
// Electrocardiograms for a simulated loop.
#include <cstdint>
#include <memory>
#include <vector>

#include "servo/ecg/ecg_monitor.hpp"
#include "servo/ecg/ecg_record.hpp"
#include "sim/heart/ecg_options.hpp"

namespace heartservo::sim {

/// One beat's waves as Gaussians (after McSharry et al., IEEE Trans. Biomed. Eng. 50 (2003) 289-294): P, Q, R, S and T,
/// R of 1 mV; a beat that comes early (less than 0.8 of the interval before) is drawn as a ventricular ectopic one:
/// wide, without P, T upside down. mV at time `t` of a heart that beats at `r_peaks_s` (increasing); beyond them it
/// beats on at its mean interval.
double ecg_mv(const std::vector<double>& r_peaks_s, double t);

/// ecg_mv() with noise, wander and hum, from -lead_in_s on without end. Deterministic in (options, beats, seed).
std::unique_ptr<servo::EcgSource> make_simulated_ecg(const EcgOptions& options, std::vector<double> r_peaks_s,
                                                     std::uint64_t seed);

/// A record whose time `start_s` is the loop's 0; from -lead_in_s on, or where the record begins, to its end.
std::unique_ptr<servo::EcgSource> make_recorded_ecg(const EcgOptions& options, servo::EcgRecord record);

}  // namespace heartservo::sim
