#pragma once
// One lead of an electrocardiogram on disk: a WFDB record (PhysioNet: header .hea and signal files in format 212 or
// 16), or CSV with `time_s` and one column a lead.
#include <string>
#include <vector>

namespace heartservo::servo {

struct EcgRecord {
  std::string file;           ///< the header, or the CSV file
  std::string lead;           ///< "MLII"
  std::string unit;           ///< "mV" most often; of the values
  double rate_hz = 0;         ///< samples per second, even
  double start_s = 0;         ///< time of the first sample: 0 of a WFDB record
  std::vector<double> value;  ///< NaN where the record has no sample

  double time_s(std::size_t i) const { return start_s + static_cast<double>(i) / rate_hz; }
  double duration_s() const { return static_cast<double>(value.size()) / rate_hz; }
};

/// `path`: a WFDB header (with or without .hea), or a CSV file. `lead`: "" for the first one that looks like an ECG
/// (in mV, or named as a lead), else the first. Throws InputError with file and line, ConfigError for an unknown lead.
EcgRecord read_ecg(const std::string& path, const std::string& lead = "");

/// Times of beats, s, from an annotation file: WFDB (.atr and others: beats of every kind, no rhythm marks; `rate_hz`
/// of its record), or CSV: `time_s`, or a last column of sample numbers. Strictly increasing. Throws InputError.
std::vector<double> read_annotated_beats(const std::string& file, double rate_hz);

/// The annotations of a record: the file with extension .atr beside its header; "" where there is none.
std::string annotations_of(const EcgRecord& record);

}  // namespace heartservo::servo
