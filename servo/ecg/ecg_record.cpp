#include "servo/ecg/ecg_record.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>

#include "servo/ecg/wfdb_header.hpp"
#include "tracking/settings/csv_rows.hpp"
#include "tracking/settings/errors.hpp"
#include "tracking/settings/yaml_reader.hpp"

namespace heartservo::servo {

namespace {

constexpr const char* kExpected = "a header with time_s and a column for each lead";

bool looks_like_lead(const std::string& name) {
  for (const char* lead : {"I", "II", "III", "V", "aVR", "aVL", "aVF", "MLI", "MLII", "MLIII", "ECG", "ecg"})
    if (name == lead) return true;
  return name.starts_with("MCL") || name.starts_with("ecg") || name.starts_with("ECG") ||
         (name.size() == 2 && name[0] == 'V' && std::isdigit(static_cast<unsigned char>(name[1])));
}

std::size_t chosen(const std::string& file, const std::vector<std::string>& leads, const std::string& wanted) {
  if (!wanted.empty()) {
    const auto found = std::find(leads.begin(), leads.end(), wanted);
    if (found != leads.end()) return static_cast<std::size_t>(found - leads.begin());
    throw ConfigError(fmt::format("{}: no lead '{}'{}; it has {}", file, wanted, did_you_mean(wanted, leads),
                                  fmt::join(leads, ", ")));
  }
  const auto ecg = std::find_if(leads.begin(), leads.end(), looks_like_lead);
  return ecg == leads.end() ? 0 : static_cast<std::size_t>(ecg - leads.begin());
}

EcgRecord read_wfdb(const std::string& file, const std::string& lead) {
  const WfdbHeader header = read_wfdb_header(file);
  std::vector<std::string> leads;
  for (std::size_t i = 0; i < header.signals.size(); ++i)
    leads.push_back(header.signals[i].name.empty() ? fmt::format("signal {}", i + 1) : header.signals[i].name);
  const std::size_t index = chosen(file, leads, lead);
  EcgRecord record;
  record.file = file;
  record.lead = leads[index];
  record.unit = header.signals[index].unit;
  record.rate_hz = header.frame_rate_hz * header.signals[index].per_frame;
  record.value = read_wfdb_signal(file, header, index);
  return record;
}

EcgRecord read_csv(const std::string& file, const std::string& wanted) {
  CsvRows rows(file, kExpected);
  const auto time = rows.find("time_s");
  std::vector<std::string> leads = rows.names();
  std::erase(leads, "time_s");
  if (!time || leads.empty()) rows.fail(std::string("expected ") + kExpected);
  EcgRecord record;
  record.file = file;
  record.lead = leads[chosen(file, leads, wanted)];
  const std::size_t column = *rows.find(record.lead);
  if (record.lead.ends_with("mv") || record.lead.ends_with("mV")) record.unit = "mV";
  std::vector<double> times;
  std::vector<int> lines;
  while (rows.next()) {
    const double t = rows.number(*time), value = rows.number(column);
    if (!std::isfinite(t)) rows.fail("time_s must be a time");
    if (!times.empty() && !(t > times.back()))
      rows.fail(fmt::format("time {} s after {} s; time must go on", t, times.back()));
    if (std::isinf(value)) rows.fail("a value is infinite");
    times.push_back(t);
    record.value.push_back(value);
    lines.push_back(rows.line());
  }
  if (times.size() < 2)
    throw InputError(fmt::format("{}: {} row{}; an ECG needs more", file, times.size(), times.size() == 1 ? "" : "s"));
  record.start_s = times.front();
  record.rate_hz = static_cast<double>(times.size() - 1) / (times.back() - times.front());
  for (std::size_t i = 1; i < times.size(); ++i)
    if (std::abs(times[i] - record.time_s(i)) > 0.75 / record.rate_hz)
      throw InputError(fmt::format("{}:{}: rows are not even in time: {} s where {:.6g} s is expected", file, lines[i],
                                   times[i], record.time_s(i)));
  return record;
}

// WFDB annotation format (annot(5), "MIT format"): 16-bit words, 6 bits of code and 10 of time since the last one.
std::vector<double> read_wfdb_beats(const std::string& file, double rate_hz) {
  std::ifstream in(file, std::ios::binary);
  if (!in || !std::filesystem::is_regular_file(file))
    throw InputError(file + ": cannot be read; check the path and its permissions");
  const std::string bytes((std::istreambuf_iterator<char>(in)), {});
  const auto word = [&](std::size_t at) {
    return static_cast<unsigned>(static_cast<unsigned char>(bytes[at])) |
           static_cast<unsigned>(static_cast<unsigned char>(bytes[at + 1])) << 8;
  };
  constexpr unsigned kSkip = 59, kAuxiliary = 63, kFirstOther = 60;
  // N L R a V F J A S E / Q ? e j n f r: beats of every kind, in the order of ecgcodes.h
  const auto is_beat = [](unsigned code) {
    return (code >= 1 && code <= 13) || code == 25 || code == 30 || code == 34 || code == 35 || code == 38 ||
           code == 41;
  };
  std::vector<double> beats;
  long sample = 0;
  std::size_t at = 0;
  for (; at + 1 < bytes.size(); at += 2) {
    const unsigned code = word(at) >> 10, value = word(at) & 0x3FF;
    if (code == 0 && value == 0) return beats;
    if (code == kSkip && at + 5 < bytes.size()) {
      sample += static_cast<std::int32_t>(word(at + 2) << 16 | word(at + 4));
      at += 4;
    } else if (code == kAuxiliary) {
      at += value + value % 2;
    } else if (code < kFirstOther) {
      sample += static_cast<long>(value);
      const double time = static_cast<double>(sample) / rate_hz;
      if (is_beat(code) && (beats.empty() || time > beats.back())) beats.push_back(time);
    }
  }
  throw InputError(
      fmt::format("{}: ends within an annotation, at byte {}; it is no WFDB annotation file, or not complete", file,
                  std::min(at, bytes.size())));
}

}  // namespace

EcgRecord read_ecg(const std::string& path, const std::string& lead) {
  namespace fs = std::filesystem;
  const std::string extension = fs::path(path).extension().string();
  EcgRecord record;
  if (extension == ".csv")
    record = read_csv(path, lead);
  else if (extension == ".hea" || fs::exists(path + ".hea"))
    record = read_wfdb(extension == ".hea" ? path : path + ".hea", lead);
  else if (const auto header = fs::path(path).replace_extension(".hea"); fs::exists(header))
    record = read_wfdb(header.string(), lead);
  else
    throw InputError(path + ": no such ECG; give a .csv file, or a WFDB record with its header (.hea)");
  if (record.rate_hz < 50)
    throw InputError(fmt::format("{}: lead {} has {:.4g} samples a second; R peaks need 50 or more", record.file,
                                 record.lead, record.rate_hz));
  return record;
}

std::vector<double> read_annotated_beats(const std::string& file, double rate_hz) {
  if (!file.ends_with(".csv")) return read_wfdb_beats(file, rate_hz);
  CsvRows rows(file, "a header with time_s, or sample numbers in the last column");
  const auto time = rows.find("time_s");
  const std::size_t column = time ? *time : rows.names().size() - 1;
  std::vector<double> beats;
  while (rows.next()) {
    const double t = time ? rows.number(column) : rows.number(column) / rate_hz;
    if (!std::isfinite(t)) rows.fail("a beat has no time");
    if (!beats.empty() && !(t > beats.back()))
      rows.fail(fmt::format("beat at {:.6g} s after {:.6g} s; time must go on", t, beats.back()));
    beats.push_back(t);
  }
  if (beats.empty()) throw InputError(file + ": has a header and no beats");
  return beats;
}

std::string annotations_of(const EcgRecord& record) {
  const auto file = std::filesystem::path(record.file).replace_extension(".atr");
  return record.file.ends_with(".hea") && std::filesystem::exists(file) ? file.string() : "";
}

}  // namespace heartservo::servo
