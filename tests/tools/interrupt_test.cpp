#include "tools/interrupt.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

namespace heartservo::tools {
namespace {

class InterruptBy : public testing::TestWithParam<int> {};

TEST_P(InterruptBy, IsRemembered) {
  Interrupt interrupt;
  EXPECT_FALSE(interrupt.requested());
  std::raise(GetParam());
  EXPECT_TRUE(interrupt.requested());
}

TEST_P(InterruptBy, EndsTheProcessTheSecondTime) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(
      {
        Interrupt interrupt;
        std::raise(GetParam());
        std::raise(GetParam());
      },
      testing::KilledBySignal(GetParam()), "");
}

TEST_P(InterruptBy, IsForgottenByTheNext) {
  {
    Interrupt interrupt;
    std::raise(GetParam());
  }
  EXPECT_FALSE(Interrupt().requested());
}

TEST_P(InterruptBy, PutsBackWhatWasThere) {
  static volatile std::sig_atomic_t seen = 0;
  seen = 0;
  const auto old = std::signal(GetParam(), [](int) { seen = 1; });
  { Interrupt interrupt; }
  std::raise(GetParam());
  std::signal(GetParam(), old);
  EXPECT_EQ(seen, 1);
}

INSTANTIATE_TEST_SUITE_P(Signals, InterruptBy, testing::Values(SIGINT, SIGTERM),
                         [](const auto& signal) { return signal.param == SIGINT ? "SIGINT" : "SIGTERM"; });

}  // namespace
}  // namespace heartservo::tools
