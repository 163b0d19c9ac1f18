#pragma once
// The paper's texture vector: eight features (Table 1), each mapped to [0, 1], and the distance between two (eq. 10).
#include <array>
#include <string_view>

#include "tracking/texture/matrices.hpp"

namespace heartservo::tracking {

/// In this order: energy, contrast, cluster shade, cluster prominence of the co-occurrence matrix; run-length
/// non-uniformity, short-run low grey-level emphasis; skewness, kurtosis of the grey levels.
using TextureVector = std::array<double, 8>;

/// Their names in the feature bank.
inline constexpr std::array<std::string_view, 8> kTextureNames{
    "energy", "contrast", "cluster_shade", "cluster_prominence", "RLN", "SRLGE", "skewness", "kurtosis"};

/// The eight as their formulas give them (cooccurrence_features.hpp, run_length_features.hpp,
/// first_order_features.hpp).
TextureVector raw_texture(const TextureMatrices& matrices);

/// The eight in [0, 1]. Each map is strictly monotone (for regions of one size), so nothing is clipped; with L levels,
/// R the region's longer side and n its pixels, and squash(v, h) = v / (|v| + h), which is 1/2 at v = h:
///
///   feature             range of the feature          mapped by
///   energy              [1/L^2, 1]                    1 + ln f / (2 ln L)
///   contrast            [0, (L-1)^2]                  squash(sqrt(f) / (L-1), 0.04): rms difference over the grey
///   range cluster shade       +-(2 (L-1))^3                 1/2 + 1/2 squash(f / (2 (L-1))^3, 0.1^3) cluster
///   prominence  [0, (2 (L-1))^4]              squash(f^(1/4) / (2 (L-1)), 0.1) RLN                 [0, 4 n], four
///   directions     f / (4 n) SRLGE               [1/(L R)^2, 1]                1 + ln f / (2 ln (L R)) skewness
///   unbounded                     1/2 + 1/2 squash(f, 1) kurtosis            [1, inf)                      squash(f -
///   1, 2): 1/2 for normally distributed grey values
///
/// Logarithms and roots spread out what lies within a hundredth of the range on tissue; not the cube root of shade,
/// whose slope at 0, where symmetric textures are, would make noise of it. A region without pixels gives zeros.
TextureVector texture_vector(const TextureMatrices& matrices);

/// t of eq. (10): Euclidean distance, at most sqrt(8).
double texture_distance(const TextureVector& a, const TextureVector& b);

/// The texture vector of one region after another, through memory that is kept: allocates only for a region larger than
/// all before.
class TextureDescriber {
 public:
  explicit TextureDescriber(const TextureSettings& settings) : settings_(settings) {}

  /// `usable` as in quantise().
  TextureVector describe(const GreyRegion& grey, const GreyRegion* usable = nullptr);
  /// Of the region described last.
  const TextureMatrices& matrices() const { return matrices_; }

 private:
  TextureSettings settings_;
  LevelImage levels_;
  MatrixBuilder builder_;
  TextureMatrices matrices_;
};

}  // namespace heartservo::tracking
