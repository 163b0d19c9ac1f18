#pragma once
// A run as it lies on disk (run_folder.hpp), to be looked at again.
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "tools/time_table.hpp"

namespace heartservo::tools {

struct StoredRun {
  std::filesystem::path folder;
  std::string name;        ///< of the folder
  nlohmann::json summary;  ///< has "command"
  std::string config_yaml;
  std::optional<TimeTable> frames;  ///< of frames.csv; none where the run has no such file, or no row in it

  std::string command() const { return summary["command"].get<std::string>(); }
};

/// Throws InputError, which says what is wrong with it: no folder, an unfinished run, another program's folder, a file
/// that cannot be read.
StoredRun read_run(const std::filesystem::path& folder);

}  // namespace heartservo::tools
