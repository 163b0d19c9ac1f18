#pragma once
// Discriminant function analysis: which directions, and which features, tell classes apart (Fisher 1936; Rao 1948 for
// several classes; Wilks 1932).
#include <Eigen/Core>
#include <vector>

namespace heartservo::tracking {

/// Sums of squares and products: within = sum over samples of (x - class mean)(x - class mean)^T, total likewise about
/// the mean of all; between = total - within.
struct Scatter {
  Eigen::MatrixXd within, total;
  int samples = 0, classes = 0;
};

/// `z`: samples x features; `label`: the class of each sample, 0 .. classes - 1. The within scatter gets `ridge` times
/// the samples on its diagonal (z is standardised, so this is a share of each feature's variance), and total too, which
/// keeps features that depend on each other invertible.
Scatter scatter(const Eigen::MatrixXd& z, const std::vector<int>& label, int classes, double ridge);

/// Wilks' lambda of the features `chosen`: det(within) / det(total), 1 for no discrimination, 0 for perfect. 1 for
/// none.
double wilks_lambda(const Scatter& s, const std::vector<Eigen::Index>& chosen);

struct Discriminant {
  Eigen::VectorXd power;      ///< eigenvalues of within^-1 between, descending: between over within along each function
  Eigen::MatrixXd functions;  ///< features x functions (classes - 1 at most), within variance 1 along each
};
Discriminant discriminant(const Scatter& s, const std::vector<Eigen::Index>& chosen);

/// Share of samples that the other samples' discriminant functions put into their own class (leave one out, nearest
/// class mean, equal priors).
double leave_one_out_accuracy(const Eigen::MatrixXd& z, const std::vector<int>& label, int classes,
                              const std::vector<Eigen::Index>& chosen, double ridge);

}  // namespace heartservo::tracking
