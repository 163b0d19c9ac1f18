#include "tools/shipped.hpp"

namespace heartservo::tools {

namespace fs = std::filesystem;

fs::path shipped_scenes() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (error) return {};
  // bin/heartservo of an installation; build/PRESET/heartservo of a checkout
  for (const char* way : {"../share/heartservo/scenes", "../../scenes"}) {
    const fs::path folder = (program.parent_path() / way).lexically_normal();
    if (fs::is_regular_file(folder / "pig_2007.yaml", error)) return folder;
  }
  return {};
}

std::string shipped(const std::string& name) {
  std::error_code error;
  if (fs::exists(name, error) || !name.starts_with("scenes/")) return name;
  const fs::path file = shipped_scenes().parent_path() / name;
  return fs::is_regular_file(file, error) ? file.string() : name;
}

}  // namespace heartservo::tools
