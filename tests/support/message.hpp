#pragma once
// The message of an expected exception, so that a test can look at what a user would read.
#include <string>

namespace heartservo::test {

/// What `Error` says when `action` throws it; "nothing was thrown" if none is.
template <class Error, class Action>
std::string message_of(Action&& action) {
  try {
    action();
  } catch (const Error& e) {
    return e.what();
  }
  return "nothing was thrown";
}

}  // namespace heartservo::test
