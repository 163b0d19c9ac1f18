#include "tests/bench/speed/machine_limit.hpp"

#include <algorithm>
#include <cstdint>
#include <ctime>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/bench/speed/machine_limit.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "tracking/planar/simd/fetch-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace heartservo::bench {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::ScalableTag<float>;
using V = hn::Vec<Floats>;

const char* name_of_target() { return hwy::TargetName(HWY_TARGET); }

// Operations done: 10 independent chains, so that latency does not count.
double multiply_add(std::size_t rounds, float* out) {
  const Floats d;
  const V a = hn::Set(d, 0.999F), b = hn::Set(d, 1e-3F);
  V c0 = a, c1 = a, c2 = a, c3 = a, c4 = a, c5 = a, c6 = a, c7 = a, c8 = a, c9 = a;
  for (std::size_t i = 0; i < rounds; ++i) {
    c0 = hn::MulAdd(c0, a, b), c1 = hn::MulAdd(c1, a, b), c2 = hn::MulAdd(c2, a, b), c3 = hn::MulAdd(c3, a, b);
    c4 = hn::MulAdd(c4, a, b), c5 = hn::MulAdd(c5, a, b), c6 = hn::MulAdd(c6, a, b), c7 = hn::MulAdd(c7, a, b);
    c8 = hn::MulAdd(c8, a, b), c9 = hn::MulAdd(c9, a, b);
  }
  c0 = hn::Add(hn::Add(hn::Add(c0, c1), hn::Add(c2, c3)), hn::Add(hn::Add(c4, c5), hn::Add(c6, hn::Add(c7, hn::Add(c8, c9)))));
  hn::StoreU(c0, d, out);
  return 20.0 * static_cast<double>(rounds * hn::Lanes(d));
}

// Words fetched: by the processor's gather instruction, or one by one.
template <bool kGather>
double fetch_words(const std::int32_t* words, int side, std::size_t rounds, float* out) {
  const Floats d;
  const hn::RebindToSigned<Floats> di;
  auto sum = hn::Zero(di);
  const int lanes = static_cast<int>(hn::Lanes(d));
  std::size_t count = 0;
  for (std::size_t r = 0; r < rounds; ++r)
    for (int row = 0; row < side; ++row)
      for (int i = 0; i < side; i += lanes, count += static_cast<std::size_t>(lanes))
        if constexpr (kGather)
          sum = hn::Add(sum, hn::GatherOffset(di, words, hn::Iota(di, row * side + i)));
        else
          sum = hn::Add(sum, tracking::simd::HWY_NAMESPACE::fetch(
                                 words, tracking::simd::HWY_NAMESPACE::Addresses(hn::Iota(di, row * side + i))));
  hn::StoreU(hn::ConvertTo(d, sum), d, out);
  return static_cast<double>(count);
}

double gather(const std::int32_t* words, int side, std::size_t rounds, float* out) {
  return fetch_words<true>(words, side, rounds, out);
}
double load(const std::int32_t* words, int side, std::size_t rounds, float* out) {
  return fetch_words<false>(words, side, rounds, out);
}

}  // namespace HWY_NAMESPACE
}  // namespace heartservo::bench
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace heartservo::bench {

HWY_EXPORT(name_of_target);
HWY_EXPORT(multiply_add);
HWY_EXPORT(gather);
HWY_EXPORT(load);

namespace {

double clock_s(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// The quickest of some tries: what the machine can do, not what its neighbours leave.
template <class Work>
double best_rate(const Work& work) {
  double best = 0;
  for (int i = 0; i < 7; ++i) {
    const double begin = thread_cpu_s(), done = work();
    best = std::max(best, done / (thread_cpu_s() - begin));
  }
  return best;
}

}  // namespace

double cpu_s() { return clock_s(CLOCK_PROCESS_CPUTIME_ID); }
double thread_cpu_s() { return clock_s(CLOCK_THREAD_CPUTIME_ID); }

MachineLimit measure_machine() {
  constexpr int kSide = 256;
  float sink[64];
  MachineLimit limit;
  limit.instructions = HWY_DYNAMIC_DISPATCH(name_of_target)();
  limit.gflops = 1e-9 * best_rate([&] { return HWY_DYNAMIC_DISPATCH(multiply_add)(3'000'000, sink); });
  const std::vector<std::int32_t> picture(kSide * kSide / 4 + 64, 1);
  limit.gather_ns = 1e9 / best_rate([&] { return HWY_DYNAMIC_DISPATCH(gather)(picture.data(), kSide, 30, sink); });
  limit.load_ns = 1e9 / best_rate([&] { return HWY_DYNAMIC_DISPATCH(load)(picture.data(), kSide, 100, sink); });
  std::vector<std::uint64_t> memory(std::size_t{1} << 25, 1);
  volatile std::uint64_t seen = 0;
  limit.read_gb_s = 1e-9 * best_rate([&] {
                      std::uint64_t sum[8] = {};
                      for (std::size_t i = 0; i < memory.size(); i += 8)
                        for (std::size_t k = 0; k < 8; ++k) sum[k] += memory[i + k];
                      for (const std::uint64_t s : sum) seen = seen + s;
                      return 8.0 * static_cast<double>(memory.size());
                    });
  return limit;
}

}  // namespace heartservo::bench
#endif
