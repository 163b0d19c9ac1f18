#include "servo/ecg/wfdb_header.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "tracking/settings/errors.hpp"

namespace heartservo::servo {

namespace {

// Takes pieces of one field from its front: "212x4:4+24", "200(1024)/mV".
class Field {
 public:
  explicit Field(std::string_view text) : rest_(text) {}
  bool take(char mark) {
    if (!rest_.starts_with(mark)) return false;
    rest_.remove_prefix(1);
    return true;
  }
  template <class Number>
  bool number(Number& value) {
    const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value);
    if (error != std::errc{}) return false;
    rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
    return true;
  }
  bool done() const { return rest_.empty(); }
  std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
};

class Reader {
 public:
  explicit Reader(const std::string& file) : file_(file), in_(file) {
    if (!in_ || !std::filesystem::is_regular_file(file))
      throw InputError(file + ": cannot be read; check the path and its permissions");
  }
  // The next line that is no comment, in words; false at the end.
  bool next() {
    for (std::string line; std::getline(in_, line);) {
      ++line_;
      if (line.ends_with('\r')) line.pop_back();
      if (line.find_first_not_of(" \t") == line.npos || line[0] == '#') continue;
      words_.clear();
      std::istringstream in(line);
      for (std::string word; in >> word;) words_.push_back(word);
      return true;
    }
    return false;
  }
  const std::vector<std::string>& words() const { return words_; }
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(fmt::format("{}:{}: {}", file_, std::max(line_, 1), what));
  }

 private:
  std::string file_;
  std::ifstream in_;
  int line_ = 0;
  std::vector<std::string> words_;
};

WfdbSignal signal_of(const Reader& reader) {
  const auto& w = reader.words();
  if (w.size() < 2) reader.fail("a signal needs a file and a format");
  WfdbSignal s;
  s.file = w[0];
  Field format(w[1]);
  bool good = format.number(s.format);
  if (format.take('x')) good = good && format.number(s.per_frame);
  if (format.take(':')) good = good && format.number(s.skew);
  if (format.take('+')) good = good && format.number(s.byte_offset);
  if (!good || !format.done() || s.per_frame < 1 || s.skew < 0 || s.byte_offset < 0)
    reader.fail(fmt::format("'{}' is not a signal format such as 212 or 16+24", w[1]));
  if (s.format != 16 && s.format != 212)
    reader.fail(fmt::format("signal format {} is not supported; convert the record to 16 or 212", s.format));
  bool has_baseline = false;
  if (w.size() > 2) {
    Field gain(w[2]);
    good = gain.number(s.gain);
    if (gain.take('(')) good = good && gain.number(s.baseline) && gain.take(')'), has_baseline = true;
    if (gain.take('/')) s.unit = gain.rest();
    if (!good) reader.fail(fmt::format("'{}' is not a gain such as 200(1024)/mV", w[2]));
    if (s.gain == 0) s.gain = 200;  // "uncalibrated", by the format's definition
  }
  if (w.size() > 4 && !has_baseline) {
    Field zero(w[4]);  // the converter's zero is the baseline where none is given
    if (!zero.number(s.baseline)) reader.fail(fmt::format("'{}' is not a number", w[4]));
  }
  for (std::size_t i = 8; i < w.size(); ++i) s.name += (s.name.empty() ? "" : " ") + w[i];
  return s;
}

std::string bytes_of(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in || !std::filesystem::is_regular_file(file))
    throw InputError(file + ": cannot be read; the signals of a record lie beside its header");
  return {std::istreambuf_iterator<char>(in), {}};
}

// Sample i of the file, as the converter gave it.
int sample_16(std::string_view bytes, std::size_t i) {
  const auto low = static_cast<unsigned char>(bytes[2 * i]), high = static_cast<unsigned char>(bytes[2 * i + 1]);
  return static_cast<std::int16_t>(low | high << 8);
}
int sample_212(std::string_view bytes, std::size_t i) {
  const std::size_t pair = i / 2 * 3;
  const auto at = [&](std::size_t k) { return static_cast<int>(static_cast<unsigned char>(bytes[k])); };
  const int value = i % 2 == 0 ? at(pair) | (at(pair + 1) & 0x0F) << 8 : at(pair + 2) | (at(pair + 1) & 0xF0) << 4;
  return value >= 2048 ? value - 4096 : value;
}
std::size_t samples_in(std::string_view bytes, int format) {
  return format == 16 ? bytes.size() / 2 : bytes.size() / 3 * 2 + (bytes.size() % 3 == 2 ? 1 : 0);
}

}  // namespace

WfdbHeader read_wfdb_header(const std::string& file) {
  Reader reader(file);
  if (!reader.next()) throw InputError(file + ":1: is empty; expected the header of a WFDB record");
  const auto record = reader.words();
  if (record[0].find('/') != record[0].npos) reader.fail("records of several segments are not supported");
  WfdbHeader header;
  int count = 0;
  if (record.size() < 2 || !Field(record[1]).number(count) || count < 1)
    reader.fail("expected 'NAME SIGNALS RATE SAMPLES', the header of a WFDB record");
  if (record.size() > 2 && (!Field(record[2]).number(header.frame_rate_hz) || !(header.frame_rate_hz > 0)))
    reader.fail(fmt::format("'{}' is not a sampling rate", record[2]));
  if (record.size() > 3 && !Field(record[3]).number(header.frames))
    reader.fail(fmt::format("'{}' is not a number of samples", record[3]));
  for (int i = 0; i < count; ++i) {
    if (!reader.next()) reader.fail(fmt::format("{} signals are announced, {} described", count, i));
    header.signals.push_back(signal_of(reader));
  }
  return header;
}

std::vector<double> read_wfdb_signal(const std::string& header_file, const WfdbHeader& header, std::size_t index) {
  const WfdbSignal& signal = header.signals.at(index);
  // a frame of the file holds per_frame samples of each of its signals, in the header's order
  std::size_t frame = 0, before = 0;
  for (std::size_t i = 0; i < header.signals.size(); ++i) {
    if (header.signals[i].file != signal.file) continue;
    if (i < index) before += static_cast<std::size_t>(header.signals[i].per_frame);
    frame += static_cast<std::size_t>(header.signals[i].per_frame);
  }
  const std::string path = (std::filesystem::path(header_file).parent_path() / signal.file).string();
  const std::string content = bytes_of(path);
  const std::string_view bytes = std::string_view(content).substr(
      std::min<std::size_t>(static_cast<std::size_t>(signal.byte_offset), content.size()));
  const std::size_t held = samples_in(bytes, signal.format) / frame;
  const std::size_t frames = header.frames > 0 ? header.frames : held;
  if (held < frames)
    throw InputError(fmt::format("{}: ends after {} of {} samples; it is not complete", path, held, frames));
  std::vector<double> values;
  const auto per_frame = static_cast<std::size_t>(signal.per_frame), skew = static_cast<std::size_t>(signal.skew);
  values.reserve(frames * per_frame);
  const int missing = signal.format == 16 ? -32768 : -2048;
  for (std::size_t f = 0; f < frames; ++f)
    for (std::size_t k = 0; k < per_frame; ++k) {
      if (f + skew >= held) {
        values.push_back(NAN);
        continue;
      }
      const std::size_t at = (f + skew) * frame + before + k;
      const int raw = signal.format == 16 ? sample_16(bytes, at) : sample_212(bytes, at);
      values.push_back(raw == missing ? NAN : (raw - signal.baseline) / signal.gain);
    }
  return values;
}

}  // namespace heartservo::servo
