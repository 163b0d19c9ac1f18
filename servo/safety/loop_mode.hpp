#pragma once

namespace heartservo::servo {

/// What the command of a frame was based on.
enum class LoopMode {
  FOLLOW,   ///< target seen in this frame
  COAST,    ///< target lost a moment ago: its prediction is followed
  HOLD,     ///< target lost for too long, or not yet known: the tool stands at the last safe place
  RETRACT,  ///< target still lost: the tool goes back along its axis, away from the tissue, and waits there
  RESUME,   ///< target back for long enough: the tool approaches its goal slowly
};

}  // namespace heartservo::servo
