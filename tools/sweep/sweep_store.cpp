#include "tools/sweep/sweep_store.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>

#include "tracking/settings/errors.hpp"

namespace heartservo::tools {

namespace fs = std::filesystem;

namespace {

// Quoted where it holds what would end a cell.
std::string cell(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  if (text.find_first_of(",\"") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::vector<std::string> cells(const std::string& line) {
  std::vector<std::string> result(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quoted && c == '"' && i + 1 < line.size() && line[i + 1] == '"')
      result.back() += line[++i];
    else if (c == '"')
      quoted = !quoted;
    else if (c == ',' && !quoted)
      result.emplace_back();
    else
      result.back() += c;
  }
  return result;
}

void write_whole(const fs::path& file, const std::string& text) {
  const fs::path partial = file.string() + ".partial";
  std::ofstream out(partial, std::ios::binary);
  out << text;
  out.close();
  std::error_code error;
  if (out) fs::rename(partial, file, error);
  if (!out || error)
    throw ConfigError(fmt::format("{}: cannot be written; check space and permissions", file.string()));
}

std::string header_of(const SweepPlan& plan) {
  std::string line = "run";
  for (const auto& axis : plan.axes) line.append(",").append(cell(axis.key));
  line += ",status";
  for (const auto& metric : plan.metrics) line.append(",").append(cell(metric));
  return line + ",seconds,error\n";
}

}  // namespace

std::map<std::uint64_t, SweepResult> read_results(const fs::path& file, const SweepPlan& plan) {
  std::map<std::uint64_t, SweepResult> results;
  std::ifstream in(file);
  std::string line;
  std::size_t number = 0;
  const std::size_t columns = 4 + plan.axes.size() + plan.metrics.size();
  while (std::getline(in, line)) {
    ++number;
    if (number == 1) {
      if (line + "\n" != header_of(plan))
        throw ConfigError(
            fmt::format("{}: belongs to another sweep (other axes or metrics); choose another --out", file.string()));
      continue;
    }
    const auto c = cells(line);
    if (in.eof() || c.size() != columns) continue;  // the line in which a crash came: that run is done again
    SweepResult r;
    r.run = std::strtoull(c[0].c_str(), nullptr, 10);
    const auto values = plan.values(r.run);
    if (r.run >= plan.runs() || !std::equal(values.begin(), values.end(), c.begin() + 1))
      throw ConfigError(
          fmt::format("{}:{}: belongs to another sweep (other values); choose another --out", file.string(), number));
    r.status = c[1 + values.size()];
    for (std::size_t i = 0; i < plan.metrics.size(); ++i) {
      const std::string& text = c[2 + values.size() + i];
      r.metrics.push_back(text.empty() ? NAN : std::strtod(text.c_str(), nullptr));
    }
    r.seconds = std::strtod(c[columns - 2].c_str(), nullptr);
    r.error = c[columns - 1];
    results[r.run] = std::move(r);
  }
  return results;
}

std::string SweepStore::line_of(const SweepResult& r) const {
  std::string line = std::to_string(r.run);
  for (const auto& value : plan_.values(r.run)) line.append(",").append(cell(value));
  line += "," + r.status;
  for (const double m : r.metrics) line += std::isfinite(m) ? fmt::format(",{}", m) : ",";
  return line + fmt::format(",{:.3f},{}\n", r.seconds, cell(r.error));
}

SweepStore::SweepStore(const fs::path& folder, const SweepPlan& plan, int share, bool wait)
    : folder_(folder), plan_(plan) {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) throw ConfigError(fmt::format("{}: cannot be made: {}", folder_.string(), error.message()));
  file_ = folder_ / (share == 0 ? std::string("runs.csv") : fmt::format("runs-{}.csv", share));
  descriptor_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (descriptor_ < 0)
    throw ConfigError(fmt::format("{}: cannot be written: {}", file_.string(), std::strerror(errno)));
  if (::flock(descriptor_, wait ? LOCK_EX : LOCK_EX | LOCK_NB) != 0) {
    ::close(descriptor_);
    throw ConfigError(fmt::format("{}: another heartservo is writing this sweep; wait for it or choose another --out",
                                  file_.string()));
  }
  try {
    results_ = read_results(file_, plan_);
  } catch (...) {
    ::close(descriptor_);
    throw;
  }
  char last = '\n';
  if (const auto size = static_cast<off_t>(fs::file_size(file_)); size > 0)
    if (::pread(descriptor_, &last, 1, size - 1) == 1 && last != '\n' && ::write(descriptor_, "\n", 1) != 1)
      throw ConfigError(fmt::format("{}: cannot be written: {}", file_.string(), std::strerror(errno)));
  if (fs::file_size(file_) == 0) {
    const std::string first = header_of(plan_);
    if (::write(descriptor_, first.data(), first.size()) != static_cast<ssize_t>(first.size()))
      throw ConfigError(fmt::format("{}: cannot be written: {}", file_.string(), std::strerror(errno)));
  }
}

SweepStore::~SweepStore() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void SweepStore::add(const SweepResult& result) {
  const std::string line = line_of(result);
  if (::write(descriptor_, line.data(), line.size()) != static_cast<ssize_t>(line.size()))
    throw ConfigError(
        fmt::format("{}: cannot be written: {}; what was done is in it", file_.string(), std::strerror(errno)));
  results_[result.run] = result;
}

void SweepStore::forget_failed() {
  std::erase_if(results_, [](const auto& r) { return r.second.status == "failed"; });
}

std::map<std::uint64_t, SweepResult> SweepStore::elsewhere() const {
  std::map<std::uint64_t, SweepResult> found;
  for (const auto& entry : fs::directory_iterator(folder_)) {
    const std::string name = entry.path().filename();
    if (!name.starts_with("runs") || !name.ends_with(".csv") || entry.path() == file_) continue;
    if (entry.is_regular_file() && entry.file_size() == 0) continue;  // just made by another process
    for (auto& [run, result] : read_results(entry.path(), plan_))
      if (const auto known = found.find(run); known == found.end() || known->second.status == "failed")
        found[run] = std::move(result);
  }
  return found;
}

void SweepStore::merge() {
  for (const auto& [run, result] : elsewhere())
    if (!has(run) || (results_[run].status == "failed" && result.status != "failed")) add(result);
}

void SweepStore::write_sorted() const {
  std::string text = header_of(plan_);
  for (const auto& [run, result] : results_) text += line_of(result);
  write_whole(folder_ / "results.csv", text);
}

}  // namespace heartservo::tools
