#pragma once
// Errors that end a command. One line each: what, where (file, line or key), what to do.
#include <stdexcept>
#include <string>

namespace heartservo {

/// Wrong usage or configuration: a bad option, key or value (exit code 2).
struct ConfigError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Unreadable or malformed input: a file, folder or stream (exit code 3).
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A device does not do what it should (exit code 4).
struct DeviceError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace heartservo
