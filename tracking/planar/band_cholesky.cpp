#include "tracking/planar/band_cholesky.hpp"

#include <algorithm>
#include <cmath>

#include "tracking/settings/target_clones.hpp"

namespace heartservo::tracking {

namespace {

HEARTSERVO_SIMD double dot(const double* __restrict a, const double* __restrict b, std::ptrdiff_t n) {
  double sum = 0;
#pragma omp simd reduction(+ : sum)
  for (std::ptrdiff_t i = 0; i < n; ++i) sum += a[i] * b[i];
  return sum;
}

// The factor's rows one after the other; each begins where that of A does.
HEARTSERVO_SIMD bool factor(double* A, std::ptrdiff_t n, std::ptrdiff_t band) {
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    double* const row = A + i * n;
    const std::ptrdiff_t begin = i + 1 == n ? 0 : std::max<std::ptrdiff_t>(0, i - band);
    for (std::ptrdiff_t j = begin; j < i; ++j) {
      const double* other = A + j * n;
      const std::ptrdiff_t first = std::max(begin, std::max<std::ptrdiff_t>(0, j - band));
      double sum = row[j];
#pragma omp simd reduction(- : sum)
      for (std::ptrdiff_t k = first; k < j; ++k) sum -= row[k] * other[k];
      row[j] = sum * other[j];  // the diagonal holds the inverse
    }
    double pivot = row[i];
    for (std::ptrdiff_t k = begin; k < i; ++k) pivot -= row[k] * row[k];
    if (!(pivot > 0) || !std::isfinite(pivot)) return false;
    row[i] = 1 / std::sqrt(pivot);
  }
  return true;
}

}  // namespace

bool solve_banded(RowMatrix& A, int band, Eigen::VectorXd& b) {
  const Eigen::Index n = A.rows();
  if (!factor(A.data(), n, band)) return false;
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Index begin = i + 1 == n ? 0 : std::max<Eigen::Index>(0, i - band);
    b(i) = (b(i) - dot(A.data() + i * n + begin, b.data() + begin, i - begin)) * A(i, i);
  }
  for (Eigen::Index i = n - 1; i >= 0; --i) {
    const Eigen::Index begin = i + 1 == n ? 0 : std::max<Eigen::Index>(0, i - band);
    const double x = b(i) * A(i, i);
    b(i) = x;
    for (Eigen::Index k = begin; k < i; ++k) b(k) -= x * A(i, k);
  }
  return true;
}

}  // namespace heartservo::tracking
