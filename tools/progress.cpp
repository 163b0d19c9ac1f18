#include "tools/progress.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>

namespace heartservo::tools {

namespace {

constexpr auto PERIOD = std::chrono::milliseconds(100);
constexpr const char* WIPE = "\r\033[K";

bool is_terminal(std::FILE* stream) {
  const char* term = std::getenv("TERM");
  return ::isatty(::fileno(stream)) != 0 && (term == nullptr || std::string_view(term) != "dumb");
}

std::size_t width_of(std::FILE* stream) {
  winsize size{};
  return ::ioctl(::fileno(stream), TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

std::string duration(double seconds) {
  const auto s = static_cast<long>(seconds + 0.5);
  return s < 3600 ? fmt::format("{}:{:02}", s / 60, s % 60)
                  : fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
}

}  // namespace

std::string progress_line(std::string_view what, std::size_t done, std::size_t total, double elapsed_s,
                          std::size_t width) {
  const double rate = elapsed_s > 0 ? static_cast<double>(done) / elapsed_s : 0;
  std::string tail = total > 0 ? fmt::format(" {}/{}", std::min(done, total), total) : fmt::format(" {}", done);
  if (rate > 0) tail += rate < 10 ? fmt::format("  {:.1f} frames/s", rate) : fmt::format("  {:.0f} frames/s", rate);
  if (total > 0 && rate > 0)
    tail += fmt::format("  {} left", duration(static_cast<double>(total - std::min(done, total)) / rate));
  std::string line(what);
  const std::size_t used = what.size() + tail.size() + 3;  // " [" and "]"
  if (total > 0 && width >= used + 5) {
    const std::size_t bar = std::min<std::size_t>(width - used, 40);
    const std::size_t full = bar * std::min(done, total) / total;
    line += " [" + std::string(full, '#') + std::string(bar - full, '.') + "]";
  }
  return (line + tail).substr(0, width);
}

Progress::Progress(std::string what, std::size_t total, bool quiet, std::FILE* stream)
    : what_(std::move(what)), total_(total), stream_(stream), on_(!quiet && is_terminal(stream)) {}

void Progress::update(std::size_t done) {
  if (!on_) return;
  const auto now = Clock::now();
  if (now < next_) return;
  next_ = now + PERIOD;
  const double elapsed_s = std::chrono::duration<double>(now - start_).count();
  // one column stays free: a terminal wraps a line that fills it
  fmt::print(stream_, "{}{}", WIPE, progress_line(what_, done, total_, elapsed_s, width_of(stream_) - 1));
  std::fflush(stream_);
  drawn_ = true;
}

void Progress::finish() {
  if (drawn_) {
    std::fputs(WIPE, stream_);
    std::fflush(stream_);
  }
  drawn_ = on_ = false;
}

}  // namespace heartservo::tools
