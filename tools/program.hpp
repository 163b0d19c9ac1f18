#pragma once
#include <string>
#include <vector>

namespace heartservo::tools {

/// The program: `arguments` without its name, such as {"servo", "scenes/pig_2007.yaml"}. Returns the exit code; what went
/// wrong has been said on stderr, in one line.
int run_program(const std::vector<std::string>& arguments);

}  // namespace heartservo::tools
