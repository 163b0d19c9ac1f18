#pragma once
// A progress line on stderr: bar, frames per second, time left. Drawn only on a terminal, at most ten times a second,
// and wiped when done, so that what is printed next starts on a clean line.
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <string>
#include <string_view>

namespace heartservo::tools {

class Progress {
 public:
  /// `total` frames, 0 where nobody knows (a live camera). `stream` must outlive this.
  Progress(std::string what, std::size_t total, bool quiet, std::FILE* stream = stderr);
  ~Progress() { finish(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// `done` frames are done. Cheap enough to call for every frame.
  void update(std::size_t done);
  /// Wipes the line. Nothing is drawn afterwards.
  void finish();

 private:
  using Clock = std::chrono::steady_clock;

  std::string what_;
  std::size_t total_;
  std::FILE* stream_;
  bool on_;
  bool drawn_ = false;
  Clock::time_point start_ = Clock::now(), next_ = start_;
};

/// The line itself, at most `width` characters (an ellipsis of bar, then of text, where the terminal is narrow).
std::string progress_line(std::string_view what, std::size_t done, std::size_t total, double elapsed_s,
                          std::size_t width);

}  // namespace heartservo::tools
