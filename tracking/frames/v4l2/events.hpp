#pragma once
// What happens to a camera, by name: the same names in the event log, in summary.json and in docs/capture.md.
#include <array>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <vector>

namespace heartservo::tracking::v4l2 {

enum class Event {
  BAD_BUFFER,          ///< the driver marked it broken, or it is empty
  BAD_PICTURE,         ///< its bytes are no whole picture
  SEQUENCE_GAP,        ///< frames that the driver or the bus dropped
  SEQUENCE_RESTART,    ///< the driver's count went back or stood still
  TIME_JUMP,           ///< the driver's clock jumped or wrapped; time goes on by ours
  STREAM_ERROR,        ///< the stream is dead until it is started anew
  UNPLUGGED,           ///< the device and its node are gone
  DISCONNECTED,        ///< the device is gone, its node is still there
  NO_SIGNAL,           ///< nothing is connected to the input
  NO_LOCK,             ///< there is a signal but no stable one
  OUT_OF_RANGE,        ///< there is a signal that the device cannot receive
  SIGNAL_BACK,         ///< after one of the three above
  RESOLUTION_CHANGED,  ///< the source sends another format; the device is set up anew for it
  FROZEN_PICTURE,      ///< pictures come but do not change
  PICTURE_MOVES,       ///< after FROZEN_PICTURE
  STARVED,             ///< no good frame for too long, whatever poll() says
  RESTARTED,           ///< the stream was stopped and started anew
  REOPENED,            ///< the device was opened and set up anew
  RECOVERED,           ///< the first good frame after faults that stop frames
  GAVE_UP,             ///< it did not come back; the frames end
};

/// "bad_buffer", ...
const char* name_of(Event event);

struct EventRecord {
  double time_s = 0;
  Event event{};
  std::string detail;
};

/// Counts all events and keeps the details of the last `kept`. May be read from another thread.
class EventLog {
 public:
  explicit EventLog(std::size_t kept = 1000) : kept_(kept) {}
  void add(double time_s, Event event, std::string detail);
  std::vector<EventRecord> records() const;
  std::uint64_t count(Event event) const;
  /// By name, only those that happened.
  std::map<std::string, std::uint64_t> counts() const;

 private:
  mutable std::mutex mutex_;
  std::size_t kept_;
  std::vector<EventRecord> records_;
  std::array<std::uint64_t, static_cast<std::size_t>(Event::GAVE_UP) + 1> counts_{};
};

}  // namespace heartservo::tracking::v4l2
