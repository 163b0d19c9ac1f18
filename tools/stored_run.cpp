#include "tools/stored_run.hpp"

#include <fmt/format.h>

#include <fstream>
#include <iterator>

#include "tools/run_folder.hpp"
#include "tracking/settings/errors.hpp"

namespace heartservo::tools {

namespace fs = std::filesystem;

namespace {

std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  if (!in.good() && !in.eof()) throw InputError(file.string() + ": cannot be read");
  return text;
}

bool has_a_row(const fs::path& csv) {
  std::ifstream in(csv);
  std::string line;
  return std::getline(in, line) && std::getline(in, line) && !line.empty();
}

}  // namespace

StoredRun read_run(const fs::path& given) {
  std::error_code error;
  fs::path folder = fs::weakly_canonical(fs::absolute(given), error);
  if (!folder.has_filename()) folder = folder.parent_path();
  if (!fs::is_directory(folder, error))
    throw InputError(fmt::format("{}: is no folder; give the folder of a run, such as runs/demo", given.string()));
  if (fs::exists(folder / "incomplete", error))
    throw InputError(fmt::format("{}: is a run that was not finished; run it again", given.string()));
  if (!is_run_folder(folder))
    throw InputError(
        fmt::format("{}: is not a run of heartservo: config.yaml or summary.json is missing", given.string()));
  StoredRun run;
  run.folder = folder;
  run.name = folder.filename().string();
  run.config_yaml = text_of(folder / "config.yaml");
  try {
    run.summary = nlohmann::json::parse(text_of(folder / "summary.json"));
  } catch (const nlohmann::json::exception& e) {
    throw InputError(fmt::format("{}: is not JSON: {}", (folder / "summary.json").string(), e.what()));
  }
  if (!run.summary.is_object() || !run.summary.contains("command") || !run.summary["command"].is_string())
    throw InputError(fmt::format("{}: does not say which command made it", (folder / "summary.json").string()));
  const fs::path csv = folder / "frames.csv";
  if (fs::exists(csv, error) && has_a_row(csv)) run.frames = TimeTable::read_csv(csv);
  return run;
}

}  // namespace heartservo::tools
