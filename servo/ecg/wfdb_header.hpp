#pragma once
// Header of a WFDB record (PhysioNet, header(5)): which signals lie in which file, and how.
#include <string>
#include <vector>

namespace heartservo::servo {

struct WfdbSignal {
  std::string file;     ///< beside the header
  int format = 0;       ///< 16 or 212
  int per_frame = 1;    ///< samples in each frame of the record
  int skew = 0;         ///< frames by which this signal is written late
  int byte_offset = 0;  ///< where samples begin in the file
  double gain = 200;    ///< units of the converter per physical unit
  double baseline = 0;  ///< of the converter at physical 0
  std::string unit = "mV", name;
};

struct WfdbHeader {
  double frame_rate_hz = 250;
  std::size_t frames = 0;  ///< 0: as many as the files hold
  std::vector<WfdbSignal> signals;
};

/// Throws InputError with file and line: unreadable, not a header, several segments, a format other than 16 or 212.
WfdbHeader read_wfdb_header(const std::string& file);

/// The samples of signal `index`, in physical units; NaN where the file marks none. Throws InputError for a signal file
/// that is missing or shorter than the header says.
std::vector<double> read_wfdb_signal(const std::string& header_file, const WfdbHeader& header, std::size_t index);

}  // namespace heartservo::servo
