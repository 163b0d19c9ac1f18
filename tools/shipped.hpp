#pragma once
#include <filesystem>
#include <string>

namespace heartservo::tools {

/// The file that `name` ("scenes/pig_2007.yaml") means: itself where it exists, else the one shipped with the program,
/// below share/heartservo of an installation or in the checkout the program was built in; `name` where there is neither.
std::string shipped(const std::string& name);

/// The folder of the shipped scenes; empty when there is none.
std::filesystem::path shipped_scenes();

}  // namespace heartservo::tools
