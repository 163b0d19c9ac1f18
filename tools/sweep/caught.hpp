#pragma once
// A program that is asked something: run to its end, with what it says.
#include <string>
#include <vector>

namespace heartservo::tools {

struct Caught {
  int code = -1;         ///< its exit code; 127: there is no such program, -1: a signal ended it
  std::string out, err;  ///< without the last line feed; several lines of `err` are joined by "; "
};

Caught ask_program(const std::vector<std::string>& command);

}  // namespace heartservo::tools
