// The vector loops against plain ones, on every instruction set that this machine has.
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <Eigen/LU>
#include <algorithm>

#include "tests/support/analytic_image.hpp"
#include "tests/support/random.hpp"
#include "tests/support/scalar_alignment.hpp"
#include "tracking/planar/quad.hpp"
#include "tracking/planar/simd/copy_marked.hpp"
#include "tracking/planar/simd/select.hpp"

namespace heartservo::tracking {
namespace {

Camera pixels() {
  Camera camera;
  camera.fx = camera.fy = 1;
  return camera;
}

Camera lens() {
  Camera camera;
  camera.fx = 593.6, camera.fy = 594.5, camera.cx = 160, camera.cy = 120;
  camera.k1 = -0.241, camera.k2 = 0.207, camera.k3 = 0.005, camera.k4 = 0.008;
  return camera;
}

// With glare in the region.
cv::Mat picture() {
  cv::Mat image = test::analytic_image(320, 240);
  image(cv::Rect(150, 110, 5, 7)).setTo(255);
  return image;
}

class Kernels : public testing::TestWithParam<std::int64_t> {
 protected:
  void SetUp() override {
    hwy::GetChosenTarget().Update(GetParam());
    pyramid_.build(picture(), cv::Rect(20, 10, 290, 220), 2);
  }
  void TearDown() override { hwy::GetChosenTarget().Update(hwy::SupportedTargets()); }

  static Eigen::Matrix3d homography(const Camera& camera, double side) {
    Quad quad{Eigen::Vector2d(120, 90), {120 + side, 94}, {118 + side, 92 + 0.9 * side}, {123, 90 + 0.9 * side}};
    for (auto& c : quad) c = camera.normalise(c);
    return to_sl3(homography_between(rectangle(-1, -0.9, 2, 1.8), quad));
  }

  Patch patch_of(int width, const Camera& camera) const {
    Patch patch = make_patch(pyramid_.level(0), camera, homography(camera, width - 1), width, width * 9 / 10);
    quieten_gradient(patch);
    return patch;
  }

  ImagePyramid pyramid_;
};

TEST_P(Kernels, WarpSamplesWhatThePlainLoopSamples) {
  for (const Camera& camera : {pixels(), lens()})
    for (const int width : {5, 13, 41, 83})
      for (const int level : {0, 1})
        for (const bool is_cubic : {false, true})
          for (const bool is_bent : {false, true}) {
            SCOPED_TRACE(testing::Message() << "lens " << (camera.k1 != 0) << " width " << width << " level " << level
                                            << " cubic " << is_cubic << " bent " << is_bent);
            Patch grid;
            grid.width = width, grid.height = 7;
            grid.step = 2.0F / static_cast<float>(width - 1);
            const auto n = static_cast<std::size_t>(width * 7);
            std::vector<float> bent_x, bent_y, grey(n), inside(n), marked(n);
            for (int row = 0; row < 7; ++row)
              for (int column = 0; column < width; ++column) {
                bent_x.push_back(grid.x_of(column) + 0.01F * static_cast<float>(row));
                bent_y.push_back(grid.y_of(row) + 0.02F * static_cast<float>(column % 3));
              }
            const BentPoints bent = is_bent ? BentPoints{bent_x.data(), bent_y.data(), nullptr} : BentPoints{};
            // hangs over the picture's right side
            const Eigen::Matrix3d G = homography(camera, 200);
            const auto how = is_cubic ? Interpolation::CUBIC : Interpolation::LINEAR;
            warp(pyramid_.level(level), camera, G, grid, how, grey.data(), inside.data(), bent);
            warp(pyramid_.level(level), camera, G, grid, how, marked.data(), nullptr, bent);
            for (std::size_t i = 0; i < n; ++i) {
              const auto row = static_cast<int>(i) / width, column = static_cast<int>(i) % width;
              const Eigen::Vector2d at = is_bent ? Eigen::Vector2d(bent_x[i], bent_y[i])
                                                 : Eigen::Vector2d(grid.x_of(column), grid.y_of(row));
              const auto want = test::scalar_sample(pyramid_.level(level), camera, G, at, is_cubic);
              ASSERT_EQ(inside[i], want.inside ? 1 : 0) << i;
              ASSERT_NEAR(grey[i], want.grey, 0.05) << i;  // 1e-4 px where glare begins
              ASSERT_EQ(marked[i], want.inside ? grey[i] : 1000) << i;
            }
          }
}

TEST_P(Kernels, PointsThatAreNoNumbersAreOutside) {
  Patch grid;
  grid.width = grid.height = 9;
  grid.step = 0.25F;
  std::vector<float> grey(81), inside(81, 1);
  for (const double bad : {std::nan(""), 1e30, HUGE_VAL}) {
    warp(pyramid_.level(0), pixels(), Eigen::Matrix3d::Constant(bad), grid, Interpolation::CUBIC, grey.data(),
         inside.data());
    EXPECT_EQ(*std::max_element(inside.begin(), inside.end()), 0) << bad;
    EXPECT_TRUE(std::all_of(grey.begin(), grey.end(), [](float g) { return std::isfinite(g); })) << bad;
  }
}

TEST_P(Kernels, ThePassAddsUpWhatThePlainLoopAddsUp) {
  auto random = test::seeded();
  for (const int width : {9, 41, 80, 121}) {
    SCOPED_TRACE(width);
    const Patch patch = patch_of(width, pixels());
    const simd::EsmTemplate reference(patch);
    EXPECT_EQ(reference.usable, std::count(patch.usable.begin(), patch.usable.end(), 1.0F));
    AlignmentBuffers buffers;
    buffers.resize(patch.size());
    Eigen::Matrix3d G = homography(pixels(), width - 1);
    G(0, 2) += 0.8, G(1, 2) -= 0.5;
    warp(pyramid_.level(0), pixels(), G, patch, Interpolation::CUBIC, buffers.grey.data(), nullptr);
    for (std::size_t i = 0; i < patch.size(); ++i)  // noise, and what hides some of it
      buffers.grey[i] += static_cast<float>(test::normal(random, 2)) + (i % 7 == 0 ? 60.0F : 0.0F);
    std::vector<float> offset(patch.size() + simd::kEsmPad);
    for (std::size_t i = 0; i < patch.size(); ++i) offset[i] = 0.001F * static_cast<float>(i % 50);
    for (const float* gain_offset : {static_cast<const float*>(nullptr), static_cast<const float*>(offset.data())}) {
      const Light light{1.1, -8, gain_offset};
      AlignmentPass pass, light_pass, weighed;
      esm_pass(reference, light, buffers, pass);
      const auto want = test::scalar_pass(patch, light, buffers.grey, 1 / pass.inverse_scale);
      EXPECT_EQ(pass.points, want.points);
      EXPECT_NEAR(pass.weight, want.weight, 1e-5 * want.weight);
      for (int i = 0; i < 10; ++i) {
        const double size = std::sqrt(want.JtJ(i, i));
        EXPECT_NEAR(pass.Jtr(i), want.Jtr(i), 1e-5 * size * std::sqrt(want.points) * 10) << i;
        for (int j = 0; j < 10; ++j)
          EXPECT_NEAR(pass.JtJ(i, j), want.JtJ(i, j), 1e-5 * size * std::sqrt(want.JtJ(j, j))) << i << ", " << j;
      }
      esm_pass(reference, light, buffers, light_pass, false);
      EXPECT_EQ(light_pass.Jtr, pass.Jtr);
      EXPECT_EQ(light_pass.weight, pass.weight);
      weigh_points(reference, light, buffers, weighed);
      EXPECT_EQ(weighed.noise_grey, pass.noise_grey);
      EXPECT_NEAR(weighed.weight, want.weight, 1e-5 * want.weight);
      for (std::size_t i = 0; i < patch.size(); ++i) {
        ASSERT_NEAR(buffers.weight[i], want.weights[i], 1e-4) << i;
        if (want.weights[i] > 0) {
          ASSERT_NEAR(buffers.residual[i], want.residual[i], 1e-3) << i;
        }
      }
    }
  }
}

TEST_P(Kernels, TheNoiseIsThatOfTheMedian) {
  const Patch patch = patch_of(21, pixels());  // small enough for every point to be looked at
  const simd::EsmTemplate reference(patch);
  AlignmentBuffers buffers;
  buffers.resize(patch.size());
  warp(pyramid_.level(0), pixels(), homography(pixels(), 23), patch, Interpolation::CUBIC, buffers.grey.data(), nullptr);
  AlignmentPass pass;
  esm_pass(reference, {}, buffers, pass);
  const auto want = test::scalar_pass(patch, {}, buffers.grey, 1e6);
  std::vector<double> sizes;
  for (std::size_t i = 0; i < patch.size(); ++i)
    if (want.weights[i] > 0) sizes.push_back(std::abs(want.residual[i]));
  std::nth_element(sizes.begin(), sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2), sizes.end());
  EXPECT_NEAR(pass.noise_grey, 1.4826 * sizes[sizes.size() / 2], 1e-4);
}

TEST_P(Kernels, CorrelationLeavesOutWhatHasNoWeight) {
  const Patch patch = patch_of(41, pixels());
  const simd::EsmTemplate reference(patch);
  AlignmentBuffers buffers;
  buffers.resize(patch.size());
  warp(pyramid_.level(0), pixels(), homography(pixels(), 40), patch, Interpolation::CUBIC, buffers.grey.data(), nullptr);
  for (std::size_t i = 0; i < 600; ++i) buffers.grey[i] = 20;  // hidden
  AlignmentPass pass;
  const Light light{1.01, -0.5};
  esm_pass(reference, light, buffers, pass);
  const auto want = test::scalar_pass(patch, light, buffers.grey, 1 / pass.inverse_scale);
  const auto plain = [&](auto weight) {
    double n = 0, a = 0, c = 0, aa = 0, cc = 0, ac = 0;
    for (std::size_t i = 0; i < patch.size(); ++i) {
      const double w = weight(i), x = static_cast<double>(buffers.grey[i]), y = static_cast<double>(patch.grey[i]);
      n += w, a += w * x, c += w * y, aa += w * x * x, cc += w * y * y, ac += w * x * y;
    }
    return (ac - a * c / n) / std::sqrt((aa - a * a / n) * (cc - c * c / n));
  };
  const Correlation found = correlation(reference, light, buffers, pass);
  EXPECT_NEAR(found.believed, plain([&](std::size_t i) { return want.weights[i]; }), 1e-4);
  EXPECT_NEAR(found.all, plain([&](std::size_t i) {
                return patch.usable[i] > 0 && buffers.grey[i] < kSaturatedGrey ? 1.0 : 0.0;
              }),
              1e-4);
  EXPECT_GT(found.believed, found.all + 0.1);
}

TEST_P(Kernels, FitLightFindsGainAndBias) {
  const Patch patch = patch_of(41, pixels());
  const simd::EsmTemplate reference(patch);
  AlignmentBuffers buffers;
  buffers.resize(patch.size());
  warp(pyramid_.level(0), pixels(), homography(pixels(), 40), patch, Interpolation::CUBIC, buffers.grey.data(), nullptr);
  for (std::size_t i = 0; i < patch.size(); ++i) buffers.grey[i] = 0.8F * buffers.grey[i] + 12;
  Light light;
  ASSERT_TRUE(fit_light(reference, buffers, nullptr, light));
  EXPECT_NEAR(light.gain, 1 / 0.8, 2e-3);
  EXPECT_NEAR(light.bias, -12 / 0.8, 0.2);
  std::fill(buffers.grey.begin(), buffers.grey.end(), 90.0F);
  EXPECT_FALSE(fit_light(reference, buffers, nullptr, light));
}

TEST_P(Kernels, SelectIsNthElement) {
  auto random = test::seeded();
  for (const std::size_t n : {1, 2, 15, 16, 17, 511}) {
    simd::AlignedFloats values(n + 32, std::numeric_limits<float>::infinity());
    std::vector<float> sorted;
    for (std::size_t i = 0; i < n; ++i)
      sorted.push_back(values[i] = static_cast<float>(std::abs(i % 5 == 0 ? 1.5 : test::normal(random, 10))));
    std::sort(sorted.begin(), sorted.end());
    for (const std::size_t k : {std::size_t{0}, n / 2, n - 1}) EXPECT_EQ(simd::select(values.data(), n, k), sorted[k]);
  }
}

TEST_P(Kernels, CopyMarksWhatIsBright) {
  auto random = test::seeded();
  std::vector<unsigned char> from(77), to(77);
  for (auto& v : from) v = static_cast<unsigned char>(random() % 256);
  for (const int bright : {0, 1, 127, 128, 240, 255, 256}) {
    EXPECT_EQ(simd::copy_marked(from.data(), from.size(), bright, to.data()),
              std::any_of(from.begin(), from.end(), [&](int v) { return v >= bright; }))
        << bright;
    for (std::size_t i = 0; i < from.size(); ++i) {
      EXPECT_EQ(to[i], from[i] >= bright ? 255 : from[i]) << i << ", " << bright;
    }
  }
  const unsigned char dark[40] = {};
  EXPECT_FALSE(simd::copy_marked(dark, 40, 1, to.data()));
}

INSTANTIATE_TEST_SUITE_P(Machine, Kernels, testing::ValuesIn(hwy::SupportedAndGeneratedTargets()),
                         [](const auto& target) { return std::string(hwy::TargetName(target.param)); });

}  // namespace
}  // namespace heartservo::tracking
