#include "tracking/planar/track.hpp"

namespace heartservo::tracking {

const char* name_of(TrackState state) {
  switch (state) {
    case TrackState::OK:
      return "OK";
    case TrackState::UNCERTAIN:
      return "UNCERTAIN";
    case TrackState::LOST:
      return "LOST";
  }
  return "LOST";
}

}  // namespace heartservo::tracking
