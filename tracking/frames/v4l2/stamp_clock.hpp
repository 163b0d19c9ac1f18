#pragma once
// The drivers' time stamps on our own clock. They may be of another clock, lie in the future, jump and wrap.
#include <cstdint>
#include <string>

namespace heartservo::tracking::v4l2 {

enum class StampOrigin {
  MONOTONIC,  ///< CLOCK_MONOTONIC, ours
  FOREIGN,    ///< another clock, or one that jumped: its zero was set so that the first frame arrived when it did
  ARRIVAL,    ///< none that can be used: when we took the frame
};

/// "monotonic", "foreign", "arrival".
const char* name_of(StampOrigin origin);

class StampClock {
 public:
  struct Stamp {
    double time_s = 0;  ///< on our clock, later than that of the frame before
    StampOrigin origin = StampOrigin::MONOTONIC;
    bool jumped = false;
    std::string jump;  ///< what it was
  };

  /// `device_s`: as the driver stamped the frame. `arrival_s`: when we took it, on our clock. `flags`: of the buffer.
  Stamp stamp(double device_s, double arrival_s, std::uint32_t flags);

  /// The next frame is the first of a new stream: what its stamp says is no jump.
  void restart() { started_ = false; }

 private:
  bool started_ = false;
  double shift_s_ = 0;  // device to ours
  double usual_age_s_ = 0;
  double last_device_s_ = 0, last_s_ = -1e300;
  StampOrigin origin_ = StampOrigin::ARRIVAL;
};

}  // namespace heartservo::tracking::v4l2
