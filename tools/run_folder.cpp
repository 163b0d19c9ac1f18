#include "tools/run_folder.hpp"

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdio>
#include <ctime>
#include <fstream>

#include "tracking/settings/errors.hpp"

namespace heartservo::tools {

namespace fs = std::filesystem;

namespace {

constexpr const char* MARK = "incomplete";

[[noreturn]] void refuse(const fs::path& path, const std::string& what) {
  throw ConfigError(fmt::format("{}: {}", path.string(), what));
}

// Absolute, without links, ".." or a '/' at the end.
fs::path resolve(const fs::path& given) {
  if (given.empty()) throw ConfigError("the run folder has no name; name one with --out");
  std::error_code error;
  fs::path path = fs::weakly_canonical(fs::absolute(given), error);
  if (error) refuse(given, fmt::format("cannot be a run folder: {}", error.message()));
  if (!path.has_filename()) path = path.parent_path();
  if (!path.has_filename()) refuse(given, "cannot be a run folder; name a folder inside it");
  return path;
}

void check_replaceable(const fs::path& path) {
  struct stat own {
  }, parent{};
  if (::lstat(path.c_str(), &own) != 0) return;
  if (!S_ISDIR(own.st_mode)) refuse(path, "exists and is not a folder; choose another name with --out");
  if (::stat(path.parent_path().c_str(), &parent) == 0 && parent.st_dev != own.st_dev)
    refuse(path, "is a mount point and cannot be replaced; name a folder inside it with --out");
  std::error_code error;
  if (!fs::is_empty(path, error) && !is_run_folder(path))
    refuse(path, "exists and is not a run of heartservo; nothing was changed, choose another name with --out");
}

// The mark, locked while this process lives: a lock that is free belongs to a crashed run.
int lock_mark(const fs::path& partial) {
  const int mark = ::open((partial / MARK).c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (mark < 0) refuse(partial, fmt::format("cannot be written: {}", std::strerror(errno)));
  if (::flock(mark, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    ::close(mark);
    refuse(partial, "another heartservo is writing this run; wait for it or choose another name with --out");
  }
  return mark;
}

void empty_but_mark(const fs::path& partial) {
  for (const auto& entry : fs::directory_iterator(partial))
    if (entry.path().filename() != MARK) fs::remove_all(entry.path());
}

}  // namespace

RunFolder::RunFolder(const fs::path& path) : path_(resolve(path)), partial_(path_.string() + ".partial") {
  check_replaceable(path_);
  std::error_code error;
  fs::create_directories(path_.parent_path(), error);
  if (error) refuse(path_.parent_path(), fmt::format("cannot be made: {}", error.message()));
  const bool made = fs::create_directory(partial_, error);
  if (error) refuse(partial_, fmt::format("cannot be made: {}", error.message()));
  if (!made && !fs::is_empty(partial_, error) && !fs::exists(partial_ / MARK))
    refuse(partial_, "exists and is not an unfinished run of heartservo; choose another name with --out");
  lock_ = lock_mark(partial_);
  try {
    empty_but_mark(partial_);
  } catch (const fs::filesystem_error& e) {
    ::close(lock_);
    refuse(partial_, fmt::format("holds an unfinished run that cannot be removed: {}", e.code().message()));
  }
}

RunFolder::~RunFolder() {
  if (finished_) return;
  std::error_code error;
  bool useful = false;
  for (const auto& entry : fs::directory_iterator(partial_, error)) useful |= entry.path().filename() != MARK;
  if (!useful) fs::remove_all(partial_, error);
  ::close(lock_);
}

fs::path RunFolder::file(std::string_view name) const { return (finished_ ? path_ : partial_) / name; }

void RunFolder::write(std::string_view name, std::string_view text) const {
  std::ofstream out(file(name), std::ios::binary);
  out << text;
  out.close();
  if (!out) refuse(file(name), fmt::format("cannot be written: {}", std::strerror(errno)));
}

void RunFolder::finish() {
  if (finished_) return;
  const auto kept = [&] { return fmt::format("the run is kept in {}", partial_.string()); };
  try {
    check_replaceable(path_);
  } catch (const ConfigError& e) {
    throw ConfigError(fmt::format("{}; {}", e.what(), kept()));
  }
  std::error_code error;
  const fs::path old = path_.string() + ".replaced";
  const bool replaces = fs::exists(path_) && !fs::is_empty(path_, error);
  if (replaces) fs::remove_all(old, error);
  fs::remove(partial_ / MARK, error);
  // rename() takes the place of an empty folder in one step. A full one gives way first; if this process dies between
  // the two, both runs are there, complete, under other names.
  if (replaces) fs::rename(path_, old, error);
  if (!error) fs::rename(partial_, path_, error);
  if (error) {
    std::ofstream(partial_ / MARK).flush();
    std::error_code ignored;
    if (replaces && !fs::exists(path_)) fs::rename(old, path_, ignored);
    refuse(path_, fmt::format("cannot be put in place: {}; {}", error.message(), kept()));
  }
  finished_ = true;
  ::close(lock_);
  if (replaces) fs::remove_all(old, error);
}

bool is_run_folder(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path / "config.yaml", error) && fs::is_regular_file(path / "summary.json", error);
}

fs::path default_run_path(std::string_view command, std::string_view stem, std::chrono::system_clock::time_point now,
                          const fs::path& root) {
  std::string name(stem);
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '.' && c != '-') c = '_';
  name.erase(0, name.find_first_not_of("._-"));
  const std::time_t seconds = std::chrono::system_clock::to_time_t(now);
  std::tm local{};
  ::localtime_r(&seconds, &local);
  const std::string base = fmt::format("{}{}{}-{:%Y%m%d-%H%M%S}", command, name.empty() ? "" : "-", name, local);
  fs::path path = root / base;
  for (int i = 2; fs::exists(path) || fs::exists(path.string() + ".partial"); ++i)
    path = root / fmt::format("{}-{}", base, i);
  return path;
}

}  // namespace heartservo::tools
