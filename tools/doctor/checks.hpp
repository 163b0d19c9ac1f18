#pragma once
// What `heartservo doctor` looks at: each finding says what was found, and for a lack how to mend it.
#include <string>
#include <vector>

namespace heartservo::tools {

struct Finding {
  enum class State { OK, NOTE, LACK };  ///< NOTE: something works less well, or is only needed for some things
  std::string subject;                  ///< "cores", "display"
  State state = State::OK;
  std::string found;     ///< one line
  std::string fix = "";  ///< what to do; empty where nothing is to be done
};

/// Everything, in the order in which people read it. Opens no window and no camera; changes nothing.
std::vector<Finding> examine_machine();

}  // namespace heartservo::tools
