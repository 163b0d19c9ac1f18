#pragma once
#include "tests/bench/speed/machine_limit.hpp"
#include "tests/bench/speed/results.hpp"

namespace heartservo::bench {

/// All times are CPU times, of the process; a machine that is busy with other things does not count.
void add_esm_rows(Results& results, const MachineLimit& machine);
void add_peer_rows(Results& results);
void add_texture_rows(Results& results);
void add_composite_rows(Results& results);
void add_deformable_rows(Results& results);
void add_pose_rows(Results& results);
void add_chain_rows(Results& results, int frames);
void add_parallel_rows(Results& results);
void add_scaling_rows(Results& results);
void add_memory_rows(Results& results, int frames);

}  // namespace heartservo::bench
