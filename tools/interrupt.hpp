#pragma once
// Ctrl-C (SIGINT) and SIGTERM as a flag that a loop asks for, so that a run ends cleanly with what was done. The second
// signal of a kind ends the process at once, as if this were not here.
#include <csignal>

namespace heartservo::tools {

/// Catches the signals while it lives and then puts back what was there. One at a time.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  /// True once a signal has come.
  bool requested() const;

 private:
  struct sigaction old_int_, old_term_;
};

}  // namespace heartservo::tools
