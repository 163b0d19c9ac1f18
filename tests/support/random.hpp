#pragma once
// A random engine seeded from the running test's name (FNV-1a), so that a failure reproduces and no two tests share draws.
#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <string>

namespace heartservo::test {

inline std::mt19937_64 seeded(std::uint64_t salt = 0) {
  const auto* info = testing::UnitTest::GetInstance()->current_test_info();
  const std::string name = std::string(info->test_suite_name()) + "." + info->name();
  std::uint64_t hash = 14695981039346656037ull ^ salt;
  for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ull;
  return std::mt19937_64(hash);
}

inline double uniform(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

inline double normal(std::mt19937_64& random, double sigma = 1) {
  return std::normal_distribution<double>(0, sigma)(random);
}

}  // namespace heartservo::test
