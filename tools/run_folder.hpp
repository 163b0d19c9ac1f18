#pragma once
// A run's folder appears under its name only when it is complete. The work happens beside it in `NAME.partial`, which
// carries a file `incomplete`; finish() removes the mark and renames. A crash leaves `NAME.partial`, never a folder
// that looks finished.
#include <chrono>
#include <filesystem>
#include <string>
#include <string_view>

namespace heartservo::tools {

class RunFolder {
 public:
  /// Makes `path`.partial, and the folders above it. A left-over of a crashed run is replaced. Throws ConfigError,
  /// naming the place: it cannot be written; `path` exists and is neither empty nor a run folder; another process is
  /// writing it.
  explicit RunFolder(const std::filesystem::path& path);
  /// Without finish(): removes the partial folder if nothing was written to it, else leaves it with its mark.
  ~RunFolder();
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;

  /// Where the run will be found after finish(); absolute.
  const std::filesystem::path& path() const { return path_; }
  /// A file of the run, where it is now: below `path`.partial, and after finish() below `path`.
  std::filesystem::path file(std::string_view name) const;
  /// Writes a whole file of the run. Throws ConfigError (no space, no permission).
  void write(std::string_view name, std::string_view text) const;

  /// Puts the folder under its name, in place of the run that was there. Throws ConfigError and keeps the partial
  /// folder when the name has become unavailable meanwhile.
  void finish();

 private:
  std::filesystem::path path_, partial_;
  int lock_ = -1;
  bool finished_ = false;
};

/// True for a folder that a run left: it has config.yaml and summary.json.
bool is_run_folder(const std::filesystem::path& path);

/// `root`/<command>-<stem>-<YYYYmmdd-HHMMSS> in local time, with -2, -3, ... where that exists. `stem` may be any file
/// name or device; what does not belong in a folder name becomes '_'.
std::filesystem::path default_run_path(std::string_view command, std::string_view stem,
                                       std::chrono::system_clock::time_point now = std::chrono::system_clock::now(),
                                       const std::filesystem::path& root = "runs");

}  // namespace heartservo::tools
