#include "tracking/texture/run_table.hpp"

#include <array>

namespace heartservo::tracking {

namespace {

struct Step {
  RunDirection direction;
  int dx;
};

// 1, or one more than the neighbour's when the run goes on there; without a branch, which a processor cannot guess
// here.
std::uint16_t grown(bool goes_on, std::uint16_t neighbour) {
  return static_cast<std::uint16_t>(1 + (neighbour & -static_cast<int>(goes_on)));
}

// The runs across rows: `from` is the row that was done before, if there is one.
void fill_across(const LevelRegion& picture, int y, int from, const std::array<Step, 3>& across,
                 std::vector<RunReach>& table) {
  const int w = picture.width;
  RunReach* here = table.data() + static_cast<std::ptrdiff_t>(y) * w;
  if (from < 0 || from >= picture.height) {
    for (int x = 0; x < w; ++x)
      for (const Step& step : across) here[x].reach[step.direction] = 1;
    return;
  }
  const std::uint8_t *q = picture.row(y), *known = picture.row(from);
  const RunReach* there = table.data() + static_cast<std::ptrdiff_t>(from) * w;
  for (const auto [direction, dx] : across) {
    const int first = dx < 0 ? 1 : 0, last = dx > 0 ? w - 1 : w;
    for (int x = first; x < last; ++x)
      here[x].reach[direction] = grown(q[x] == known[x + dx], there[x + dx].reach[direction]);
  }
  here[0].reach[across[1].direction] = here[w - 1].reach[across[2].direction] = 1;  // they would leave the picture
}

}  // namespace

void RunTable::build(const LevelRegion& picture) {
  width_ = picture.width;
  reach_.resize(static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height));
  constexpr std::array<Step, 3> kUpwards{{{UP, 0}, {UP_LEFT, -1}, {UP_RIGHT, 1}}};
  constexpr std::array<Step, 3> kDownwards{{{DOWN, 0}, {DOWN_LEFT, -1}, {DOWN_RIGHT, 1}}};
  for (int y = 0; y < picture.height; ++y) fill_across(picture, y, y - 1, kUpwards, reach_);
  for (int y = picture.height - 1; y >= 0; --y) fill_across(picture, y, y + 1, kDownwards, reach_);
  const int last = picture.width - 1;
  for (int y = 0; y < picture.height; ++y) {
    const std::uint8_t* q = picture.row(y);
    RunReach* here = reach_.data() + static_cast<std::ptrdiff_t>(y) * width_;
    here[0].reach[LEFT] = here[last].reach[RIGHT] = 1;
    for (int x = 1; x <= last; ++x) here[x].reach[LEFT] = grown(q[x] == q[x - 1], here[x - 1].reach[LEFT]);
    for (int x = last - 1; x >= 0; --x) here[x].reach[RIGHT] = grown(q[x] == q[x + 1], here[x + 1].reach[RIGHT]);
  }
}

}  // namespace heartservo::tracking
