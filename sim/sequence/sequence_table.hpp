#pragma once
#include <memory>

#include "sim/sequence/sequence_options.hpp"
#include "sim/table/table.hpp"

namespace heartservo::sim {

/// An artificial sequence where a table is expected: frames, region and true corners. It has no depth and no robot:
/// robot() throws std::logic_error, the camera is an assumed pinhole. Throws ConfigError, InputError.
std::unique_ptr<Table> make_sequence_table(const SequenceOptions& options);

}  // namespace heartservo::sim
