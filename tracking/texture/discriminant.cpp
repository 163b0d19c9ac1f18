#include "tracking/texture/discriminant.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace heartservo::tracking {

namespace {

Eigen::MatrixXd part(const Eigen::MatrixXd& whole, const std::vector<Eigen::Index>& chosen) {
  return whole(chosen, chosen);
}

double log_determinant(const Eigen::MatrixXd& positive) {
  const Eigen::LDLT<Eigen::MatrixXd> factors(positive);
  return factors.vectorD().array().max(1e-300).log().sum();
}

struct ClassMeans {
  Eigen::MatrixXd sum;  // features x classes
  Eigen::VectorXd count;
};

ClassMeans class_sums(const Eigen::MatrixXd& z, const std::vector<int>& label, int classes) {
  ClassMeans m{Eigen::MatrixXd::Zero(z.cols(), classes), Eigen::VectorXd::Zero(classes)};
  for (Eigen::Index i = 0; i < z.rows(); ++i) {
    const int c = label[static_cast<std::size_t>(i)];
    m.sum.col(c) += z.row(i).transpose();
    m.count(c) += 1;
  }
  return m;
}

}  // namespace

Scatter scatter(const Eigen::MatrixXd& z, const std::vector<int>& label, int classes, double ridge) {
  const auto n = static_cast<double>(z.rows());
  const ClassMeans m = class_sums(z, label, classes);
  Eigen::MatrixXd within = z.transpose() * z;
  Scatter s;
  const Eigen::VectorXd mean = z.colwise().mean();
  s.total = within - n * mean * mean.transpose();
  for (int c = 0; c < classes; ++c)
    if (m.count(c) > 0) within -= m.sum.col(c) * m.sum.col(c).transpose() / m.count(c);
  s.within = within;
  s.within.diagonal().array() += ridge * n;
  s.total.diagonal().array() += ridge * n;
  s.samples = static_cast<int>(z.rows());
  s.classes = classes;
  return s;
}

double wilks_lambda(const Scatter& s, const std::vector<Eigen::Index>& chosen) {
  if (chosen.empty()) return 1;
  return std::exp(log_determinant(part(s.within, chosen)) - log_determinant(part(s.total, chosen)));
}

Discriminant discriminant(const Scatter& s, const std::vector<Eigen::Index>& chosen) {
  const Eigen::MatrixXd within = part(s.within, chosen) / std::max(1, s.samples - s.classes);
  const Eigen::MatrixXd between = (part(s.total, chosen) - part(s.within, chosen)) / std::max(1, s.samples - s.classes);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(between, within);
  const Eigen::Index count = std::min<Eigen::Index>(static_cast<Eigen::Index>(chosen.size()), s.classes - 1);
  Discriminant result;
  result.power = solver.eigenvalues().reverse().head(count).cwiseMax(0);
  result.functions = solver.eigenvectors().rowwise().reverse().leftCols(count);
  return result;
}

double leave_one_out_accuracy(const Eigen::MatrixXd& z, const std::vector<int>& label, int classes,
                              const std::vector<Eigen::Index>& chosen, double ridge) {
  const Eigen::MatrixXd x = z(Eigen::all, chosen);
  const ClassMeans all = class_sums(x, label, classes);
  const Scatter s = scatter(x, label, classes, ridge);
  int right = 0;
  for (Eigen::Index i = 0; i < x.rows(); ++i) {
    const int own = label[static_cast<std::size_t>(i)];
    if (all.count(own) < 2) continue;  // nothing of its class is left
    // Without sample i the class mean moves by e / (n - 1), and the within scatter loses n / (n - 1) e e^T.
    const double n = all.count(own);
    const Eigen::VectorXd sample = x.row(i).transpose(), e = sample - all.sum.col(own) / n;
    const Eigen::LDLT<Eigen::MatrixXd> within(s.within - n / (n - 1) * e * e.transpose());
    int nearest = -1;
    double least = 0;
    for (int c = 0; c < classes; ++c) {
      if (all.count(c) <= 0) continue;
      const Eigen::VectorXd mean = c == own ? Eigen::VectorXd((all.sum.col(c) - sample) / (n - 1))
                                            : Eigen::VectorXd(all.sum.col(c) / all.count(c));
      const Eigen::VectorXd off = sample - mean;
      const double distance = off.dot(within.solve(off));
      if (nearest < 0 || distance < least) {
        nearest = c;
        least = distance;
      }
    }
    right += nearest == own;
  }
  return static_cast<double>(right) / static_cast<double>(x.rows());
}

}  // namespace heartservo::tracking
