#include "tracking/texture/selection.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "tests/support/random.hpp"

namespace heartservo::tracking {
namespace {

using test::normal;

// Three classes; "good" tells the first from the others, "fair" the second from the third, "copy" is good with a little
// noise, the others are noise.
FeatureTable three_classes(std::mt19937_64& random, int per_class = 60) {
  FeatureTable table{{"noise_a", "copy", "fair", "noise_b", "good"}, {"a", "b", "c"}, {}, {}};
  table.values.resize(3 * per_class, 5);
  for (int i = 0; i < 3 * per_class; ++i) {
    const int c = i % 3;
    const double good = (c == 0 ? 8 : 0) + normal(random), fair = (c == 1 ? 3 : 0) + normal(random);
    table.values.row(i) << normal(random), 100 + 5 * (good + 0.05 * normal(random)), 1e-3 * fair, normal(random), good;
    table.label.push_back(c);
  }
  return table;
}

SelectionOptions choose(int count) {
  SelectionOptions options;
  options.count = count;
  return options;
}

TEST(Selection, FindsWhatTellsClassesApartAndPassesOverCopies) {
  auto random = test::seeded();
  const auto selection = select_features(three_classes(random), choose(2));
  ASSERT_EQ(selection.ranking.size(), 5u);
  EXPECT_TRUE(selection.ranking[0].feature == 4 || selection.ranking[0].feature == 1);
  EXPECT_EQ(selection.ranking[1].feature, 2u);
  EXPECT_EQ(selection.ranking[4].feature, selection.ranking[0].feature == 4 ? 1u : 4u);
  EXPECT_EQ(selection.ranking[4].redundant_with, selection.ranking[0].feature);
  EXPECT_GT(selection.ranking[4].F_alone, 100 * selection.ranking[3].F_alone) << "alone, the copy is good";
  EXPECT_LT(selection.ranking[3].F_to_enter, 6) << "noise";
  EXPECT_GT(selection.accuracy, 0.9);
  EXPECT_LT(quality_of(three_classes(random), {0, 3}).accuracy, 0.5) << "noise guesses one of three";
  EXPECT_EQ(selection.discriminant.power.size(), 2) << "one function less than classes";
}

TEST(Selection, LambdaAndPowerAgree) {
  auto random = test::seeded();
  const auto table = three_classes(random);
  const auto z = standardised(table.values);
  const Scatter s = scatter(z, table.label, 3, 0);
  const std::vector<Eigen::Index> chosen{0, 2, 4};
  // det(W) / det(T) = product of 1 / (1 + power), another way than determinants
  double product = 1;
  for (const double power : discriminant(s, chosen).power) product /= 1 + power;
  EXPECT_NEAR(wilks_lambda(s, chosen), product, 1e-10);
  const Eigen::MatrixXd W = s.within(chosen, chosen), T = s.total(chosen, chosen);
  EXPECT_NEAR(wilks_lambda(s, chosen), W.determinant() / T.determinant(), 1e-10);
}

TEST(Selection, LambdaIsTheHandComputedOne) {
  // one feature, classes {0, 2} and {4, 6}: within 2 + 2, total 20
  Eigen::MatrixXd x(4, 1);
  x << 0, 2, 4, 6;
  EXPECT_NEAR(wilks_lambda(scatter(x, {0, 0, 1, 1}, 2, 0), {0}), 4.0 / 20, 1e-12);
}

TEST(Selection, LeavesOneOutAsIfItWereGone) {
  auto random = test::seeded();
  const auto table = three_classes(random, 8);
  const auto z = standardised(table.values);
  const std::vector<Eigen::Index> chosen{0, 2, 3};
  int right = 0;
  for (Eigen::Index i = 0; i < z.rows(); ++i) {  // the plain way: everything again without sample i
    std::vector<Eigen::Index> rest;
    for (Eigen::Index k = 0; k < z.rows(); ++k)
      if (k != i) rest.push_back(k);
    Eigen::MatrixXd within = Eigen::MatrixXd::Zero(3, 3), mean = Eigen::MatrixXd::Zero(3, 3);
    Eigen::Vector3d count = Eigen::Vector3d::Zero();
    for (const auto k : rest) {
      mean.col(table.label[static_cast<std::size_t>(k)]) += z.row(k)(chosen).transpose();
      count(table.label[static_cast<std::size_t>(k)]) += 1;
    }
    mean = mean * count.cwiseInverse().asDiagonal();
    for (const auto k : rest) {
      const Eigen::Vector3d e = z.row(k)(chosen).transpose() - mean.col(table.label[static_cast<std::size_t>(k)]);
      within += e * e.transpose();
    }
    Eigen::Vector3d distance;
    for (int c = 0; c < 3; ++c) {
      const Eigen::Vector3d e = z.row(i)(chosen).transpose() - mean.col(c);
      distance(c) = e.dot(within.inverse() * e);
    }
    Eigen::Index nearest = 0;
    distance.minCoeff(&nearest);
    right += nearest == table.label[static_cast<std::size_t>(i)];
  }
  EXPECT_NEAR(leave_one_out_accuracy(z, table.label, 3, chosen, 0), right / static_cast<double>(z.rows()), 1e-12);
}

TEST(PrincipalComponents, AreThoseOfTwoCorrelatedFeatures) {
  auto random = test::seeded();
  Eigen::MatrixXd x(4000, 3);
  for (Eigen::Index i = 0; i < x.rows(); ++i) {
    const double common = normal(random);
    x.row(i) << 3 * common + 3 * normal(random), 7 - common - normal(random), normal(random);  // correlation -1/2
  }
  const auto z = standardised(x);
  EXPECT_NEAR(z.col(1).mean(), 0, 1e-12);
  EXPECT_NEAR(z.col(0).squaredNorm() / 4000, 1, 1e-12);
  const auto pca = principal_components(z);
  EXPECT_NEAR(pca.explained(0), 1.5 / 3, 0.02);
  EXPECT_NEAR(pca.explained(2), 0.5 / 3, 0.02);
  EXPECT_NEAR(pca.explained.sum(), 1, 1e-12);
  EXPECT_NEAR(std::abs(pca.loadings(0, 0)), std::sqrt(0.75), 0.02);
  EXPECT_LT(pca.loadings(0, 0) * pca.loadings(1, 0), 0);
  EXPECT_NEAR(pca.communality(3)(2), 1, 1e-9);
  EXPECT_EQ(pca.components_for(0.6), 2);
}

TEST(Selection, SaysWhyATableCannotBeUsed) {
  auto random = test::seeded();
  FeatureTable table = three_classes(random);
  EXPECT_EQ(problem_of(table, choose(2)), "");
  FeatureTable one = table;
  one.classes = {"a"};
  EXPECT_NE(problem_of(one, choose(2)).find("one class only, 'a'"), std::string::npos);
  FeatureTable few = table;
  few.values = table.values.topRows(7).eval();
  few.label.resize(7);
  EXPECT_NE(problem_of(few, choose(2)).find("7 samples are too few for 5 features and 3 classes"), std::string::npos);
  FeatureTable lonely = table;
  lonely.classes.emplace_back("d");
  lonely.label[0] = 3;
  EXPECT_EQ(problem_of(lonely, choose(2)), "class 'd' has fewer than two samples");
  FeatureTable broken = table;
  broken.values(3, 2) = std::nan("");
  EXPECT_NE(problem_of(broken, choose(2)), "");
  FeatureTable flat = table;
  flat.values.leftCols(4).setConstant(0.1);
  EXPECT_NE(problem_of(flat, choose(2)).find("4 of 5 features are the same in every sample"), std::string::npos);
  EXPECT_THROW(select_features(flat, choose(2)), std::invalid_argument);
}

TEST(Selection, LeavesConstantFeaturesOut) {
  auto random = test::seeded();
  FeatureTable table = three_classes(random);
  table.values.col(0).setConstant(0.1);
  const auto selection = select_features(table, choose(3));
  EXPECT_EQ(selection.constant, std::vector<std::size_t>{0});
  EXPECT_EQ(selection.ranking.size(), 4u);
  for (const auto& ranked : selection.ranking) EXPECT_NE(ranked.feature, 0u);
}

}  // namespace
}  // namespace heartservo::tracking
