// Nothing is to be taken from the heap in steady state between the frame in memory and the
// command: track, pose, predict, control. All of malloc's family is counted, of every library, as long as the loop's
// chain runs. `ibvs` alone is left out: it is ViSP's vpServo, which makes its matrices anew in every call.
#include <gtest/gtest.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>

#include "servo/loop/loop.hpp"
#include "sim/scene/scene.hpp"
#include "sim/table/stages.hpp"
#include "sim/table/table.hpp"

#if defined(__GLIBC__) && !defined(HEARTSERVO_SANITIZED)  // sanitizers have their own

namespace {
std::atomic<bool> counting{false};
std::atomic<int> allocations{0};
void count() {
  if (counting.load(std::memory_order_relaxed)) allocations.fetch_add(1, std::memory_order_relaxed);
}
}  // namespace

extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

void* malloc(std::size_t n) {
  count();
  return __libc_malloc(n);
}
void* calloc(std::size_t n, std::size_t size) {
  count();
  return __libc_calloc(n, size);
}
void* realloc(void* p, std::size_t n) {
  count();
  return __libc_realloc(p, n);
}
void* aligned_alloc(std::size_t alignment, std::size_t n) {
  count();
  return __libc_memalign(alignment, n);
}
void* memalign(std::size_t alignment, std::size_t n) {
  count();
  return __libc_memalign(alignment, n);
}
int posix_memalign(void** p, std::size_t alignment, std::size_t n) {
  count();
  *p = __libc_memalign(alignment, n);
  return *p ? 0 : ENOMEM;
}
}

namespace heartservo::sim {
namespace {

// Pictures and the robot are the world's, not the chain's: they are not counted.
class World final : public tracking::FrameSource, public servo::ToolRobot {
 public:
  explicit World(Table& table) : table_(table) {}
  bool next(tracking::Frame& frame) override {
    counting = false;
    const bool more = table_.frames().next(frame);
    counting = wanted;
    return more;
  }
  cv::Size size() const override { return table_.frames().size(); }
  double frame_rate_hz() const override { return table_.frames().frame_rate_hz(); }
  std::optional<std::size_t> frame_count() const override { return table_.frames().frame_count(); }
  std::string description() const override { return ""; }

  servo::ToolRobotData data() const override { return table_.robot().data(); }
  servo::ToolState read(double time_s) override {
    const Pause pause;
    return table_.robot().read(time_s);
  }
  void command(const servo::ToolCommand& command) override {
    const Pause pause;
    table_.robot().command(command);
  }

  bool wanted = false;  // to count from the next picture on

 private:
  struct Pause {
    bool before = counting.exchange(false);
    ~Pause() { counting = before; }
  };
  Table& table_;
};

struct Chain {
  const char *name, *scene, *tracker, *estimator, *predictor, *controller;
};

class Allocations : public testing::TestWithParam<Chain> {};

TEST_P(Allocations, TheChainTakesNothingFromTheHeap) {
  constexpr int kFirst = 60, kCounted = 25;
  const Chain& chain = GetParam();
  Scene scene = load_scene(std::string(HEARTSERVO_SOURCE_DIR "/scenes/") + chain.scene);
  scene.engines.tracker = chain.tracker;
  scene.engines.estimator = chain.estimator;
  scene.engines.predictor = chain.predictor;
  scene.engines.controller = chain.controller;
  if (scene.target.landmark < 0) scene.target.side_m = 0.008;
  const auto table = make_table(scene);
  World world(*table);
  const servo::LoopOptions options = loop_options(scene, *table);
  servo::Loop loop(world, world, make_stages(scene, *table), options, table->marker_to_tip(), [] { return 0.0; });
  const HandPicked picked = table->picked();
  ASSERT_EQ(loop.start(picked.target, picked.marker), "");
  servo::LoopRecord record;
  for (int k = 0; k < kFirst; ++k) ASSERT_TRUE(loop.step(record));
  world.wanted = true;
  for (int k = 0; k < kCounted; ++k) {
    allocations = 0;
    const bool more = loop.step(record);
    counting = false;
    ASSERT_TRUE(more);
    ASSERT_EQ(record.track.state, tracking::TrackState::OK);
    EXPECT_EQ(allocations, 0) << chain.name << ", frame " << record.frame.sequence;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Chains, Allocations,
    testing::Values(Chain{"esm", "pig_2007.yaml", "esm", "landmark_refined", "mixture", "ibvs_feedforward"},
                    Chain{"composite", "pig_2007.yaml", "composite", "landmark_refined", "harmonic", "gpc"},
                    Chain{"deformable", "pig_2007.yaml", "deformable", "landmark_linear", "autoregressive", "mpc"},
                    Chain{"dense", "pig_2007.yaml", "esm", "landmark_dense", "constant_acceleration", "ibvs_feedforward"},
                    Chain{"region", "texture_only.yaml", "deformable", "region_depth", "mixture", "ibvs_feedforward"},
                    Chain{"stereo", "stereo.yaml", "esm", "stereo_depth", "mixture", "ibvs_feedforward"}),
    [](const auto& chain) { return std::string(chain.param.name); });

}  // namespace
}  // namespace heartservo::sim

#endif
