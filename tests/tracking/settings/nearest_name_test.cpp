#include <gtest/gtest.h>

#include "tracking/settings/yaml_reader.hpp"

namespace heartservo {
namespace {

const std::vector<std::string> NAMES{"esm", "ssd", "optical_flow", "constant_velocity", "hold"};

TEST(NearestName, FindsTypingErrors) {
  EXPECT_EQ(nearest_name("optical_flwo", NAMES), "optical_flow");
  EXPECT_EQ(nearest_name("sdd", NAMES), "ssd");
  EXPECT_EQ(nearest_name("holt", NAMES), "hold");
}

TEST(NearestName, FindsBeginningsAndIgnoresCase) {
  EXPECT_EQ(nearest_name("constant", NAMES), "constant_velocity");
  EXPECT_EQ(nearest_name("ESM", NAMES), "esm");
}

TEST(NearestName, SuggestsNothingFarAway) {
  EXPECT_EQ(nearest_name("kalman", NAMES), "");
  EXPECT_EQ(nearest_name("fps", NAMES), "");
  EXPECT_EQ(nearest_name("x", {"y"}), "");
  EXPECT_EQ(nearest_name("x", {}), "");
}

TEST(NearestName, SpeaksOnlyWhenItHasASuggestion) {
  EXPECT_EQ(did_you_mean("hodl", NAMES), " (did you mean 'hold'?)");
  EXPECT_EQ(did_you_mean("kalman", NAMES), "");
}

}  // namespace
}  // namespace heartservo
