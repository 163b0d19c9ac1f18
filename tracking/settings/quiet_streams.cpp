#include "tracking/settings/quiet_streams.hpp"

#include <iostream>
#include <mutex>
#include <streambuf>

namespace heartservo {

namespace {

// Takes everything and keeps nothing, so that threads may share it.
class Nowhere final : public std::streambuf {
 protected:
  int_type overflow(int_type c) override { return traits_type::not_eof(c); }
  std::streamsize xsputn(const char*, std::streamsize n) override { return n; }
};

struct Streams {
  std::mutex mutex;
  int count = 0;
  Nowhere nowhere;
  std::streambuf *out = nullptr, *error = nullptr;
};

Streams& streams() {
  static Streams& s = *new Streams;  // lives as long as std::cout
  return s;
}

}  // namespace

QuietStreams::QuietStreams() {
  Streams& s = streams();
  const std::lock_guard lock(s.mutex);
  if (s.count++ > 0) return;
  s.out = std::cout.rdbuf(&s.nowhere);
  s.error = std::cerr.rdbuf(&s.nowhere);
}

QuietStreams::~QuietStreams() {
  Streams& s = streams();
  const std::lock_guard lock(s.mutex);
  if (--s.count > 0) return;
  std::cout.rdbuf(s.out);
  std::cerr.rdbuf(s.error);
}

}  // namespace heartservo
