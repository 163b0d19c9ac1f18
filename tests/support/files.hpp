#pragma once
// Files for tests: a folder that is gone afterwards, and the recorded data that only some machines have.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace heartservo::test {

/// An empty folder, removed with everything in it at the end of the scope.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "heartservo_test_XXXXXX").string();
    if (!mkdtemp(name.data())) throw std::runtime_error("cannot make a temporary folder " + name);
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::string path() const { return path_.string(); }
  std::string operator/(const std::string& name) const { return (path_ / name).string(); }

  /// Writes a file into the folder and returns its path.
  std::string write(const std::string& name, const std::string& content) const {
    std::ofstream(path_ / name, std::ios::binary) << content;
    return *this / name;
  }

 private:
  std::filesystem::path path_;
};

inline std::string read_all(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// A file or folder of the recorded data (environment HEARTSERVO_DATA, or ../shared/data beside the sources). May be
/// absent: then the test has to skip.
inline std::filesystem::path data(const std::string& relative) {
  const char* given = std::getenv("HEARTSERVO_DATA");
  const std::filesystem::path root = given ? given : HEARTSERVO_SOURCE_DIR "/../shared/data";
  return root / relative;
}

}  // namespace heartservo::test

/// Ends the running test as skipped where the recorded data is absent.
#define SKIP_WITHOUT_DATA(path) \
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << (path) << "; set HEARTSERVO_DATA to the recorded data"
