#include "tracking/texture/sliding_texture.hpp"

#include <gtest/gtest.h>

#include "tests/tracking/texture/texture_support.hpp"

namespace heartservo::tracking {
namespace {

class Sliding : public testing::Test {
 protected:
  bool equals_fresh_build(const SlidingTexture& sliding, const LevelImage& picture, int distance) {
    builder_.build(picture.region(sliding.x(), sliding.y(), sliding.width(), sliding.height()), distance, fresh_);
    return sliding.matrices() == fresh_;
  }

  MatrixBuilder builder_;
  TextureMatrices fresh_;
};

TEST_F(Sliding, EqualsAFreshBuildEverywhere) {
  auto random = test::seeded();
  struct Case {
    int levels, distance, width, height;
    bool left_out;
  };
  for (const Case& c : {Case{32, 1, 12, 12, false},
                        {4, 1, 16, 9, false},
                        {2, 3, 7, 15, false},
                        {64, 2, 5, 5, false},
                        {3, 1, 12, 14, true},
                        {3, 6, 5, 12, true},
                        {2, 1, 1, 8, false},
                        {2, 1, 8, 1, false}}) {
    const auto picture = test::random_levels(random, 31, 26, c.levels, c.left_out);
    SlidingTexture sliding({c.levels, c.distance, "full"}, c.width, c.height);
    sliding.load(picture.region());
    sliding.place(0, 0);
    int direction = 1, places = 0;
    do {  // a serpentine through every place
      do {
        ASSERT_TRUE(equals_fresh_build(sliding, picture, c.distance))
            << c.levels << " levels, distance " << c.distance << ", " << c.width << " x " << c.height << " at "
            << sliding.x() << ", " << sliding.y();
        ++places;
      } while (sliding.move(direction, 0));
      direction = -direction;
    } while (sliding.move(0, 1));
    EXPECT_EQ(places, (31 - c.width + 1) * (26 - c.height + 1));
  }
}

TEST_F(Sliding, EqualsAFreshBuildAfterAnyWalk) {
  auto random = test::seeded();
  const auto picture = test::random_levels(random, 90, 80, 16);
  SlidingTexture sliding({16, 1, "full"}, 40, 36);
  sliding.load(picture.region());
  sliding.place(25, 20);
  std::uniform_int_distribution<int> step(-8, 8);
  int moved = 0;
  for (int i = 0; i < 400; ++i) {
    const int x = sliding.x(), y = sliding.y(), dx = step(random), dy = step(random);
    const bool inside = x + dx >= 0 && y + dy >= 0 && x + dx <= 50 && y + dy <= 44;
    ASSERT_EQ(sliding.move(dx, dy), inside);
    EXPECT_EQ(sliding.x(), inside ? x + dx : x);
    moved += inside;
    ASSERT_TRUE(equals_fresh_build(sliding, picture, 1)) << "step " << i;
  }
  EXPECT_GT(moved, 150);
}

TEST_F(Sliding, TakesTheNextPicture) {
  auto random = test::seeded();
  SlidingTexture sliding({8, 1, "full"}, 12, 12);
  for (const int side : {40, 20, 33}) {
    const auto picture = test::random_levels(random, side, side + 3, 8);
    sliding.load(picture.region());
    sliding.place(1, 2);
    ASSERT_TRUE(sliding.move(1, 1));
    EXPECT_TRUE(equals_fresh_build(sliding, picture, 1)) << side;
  }
}

TEST_F(Sliding, CutsRunsOfAFlatPictureAtTheWindow) {
  const LevelImage picture{60, 60, 4, std::vector<std::uint8_t>(3600, 2)};
  SlidingTexture sliding({4, 1, "full"}, 12, 20);
  sliding.load(picture.region());
  sliding.place(20, 20);
  sliding.move(1, 0);
  // 20 rows of 12, 12 columns of 20, and in each diagonal direction 9 lines of the full 12.
  EXPECT_EQ(sliding.matrices().runs.count(2, 20), 12u);
  EXPECT_EQ(sliding.matrices().runs.count(2, 12), 20u + 2 * 9);
  EXPECT_EQ(sliding.matrices().runs.count(2, 11), 4u);
}

}  // namespace
}  // namespace heartservo::tracking
