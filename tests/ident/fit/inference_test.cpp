#include <cmath>

#include "ident/fit/fit_window.hpp"
#include "tests/ident/ident_test_support.hpp"
#include "tests/support/confidence.hpp"

namespace modebank {
namespace {

using test::confidence_region;

constexpr Loss all_losses[] = {Loss::trivial, Loss::huber, Loss::cauchy, Loss::softlone, Loss::tukey, Loss::arctan};

/// R^2 about the mean, with the robust weight of each transition in both sums.
double r_squared(const Trajectory& run, const Eigen::VectorXd& theta, Loss kind, double sigma) {
  const Index N = run.transitions();
  const RobustLoss loss(kind, 0.0);
  const Eigen::ArrayXd d = (run.state.rightCols(N) - run.state.leftCols(N)).transpose();
  const Eigen::ArrayXd e =
      d - (theta(0) * run.state.leftCols(N) + theta.tail<2>().transpose() * run.input.leftCols(N)).transpose().array();
  const Eigen::ArrayXd omega = (e / sigma).square().unaryExpr([&](double square) { return loss(square).weight; });
  return 1.0 - (omega * e.square()).sum() / (omega * (d - (omega * d).sum() / omega.sum()).square()).sum();
}

TEST(Quality, CountsSamplesByTheirRobustWeights) {
  constexpr double sigma = 0.05;
  std::mt19937_64 generator(3);
  Trajectory run = test::gaussian_run(test::skid_structure, Eigen::Vector3d(-0.3, -0.4, 0.5), sigma, 31, generator);
  run.state(0, 11) += 0.5;
  for (const Loss loss : all_losses) {
    const LocalModel fit = fit_window(run, 0, test::skid_structure, test::whole_run(run, loss),
                                      Eigen::VectorXd::Constant(1, sigma), nullptr);
    EXPECT_NEAR(fit.r_squared(0), r_squared(run, fit.theta, loss, sigma), 1e-12) << name_of(loss);
  }
}

TEST(Quality, OfAConstantStateIsUndefined) {
  Trajectory run = test::make_run(Eigen::MatrixXd::Constant(1, 26, 2.0), Eigen::MatrixXd::Random(2, 26));
  const LocalModel fit = fit_window(run, 0, test::skid_structure, test::whole_run(run, Loss::huber),
                                    Eigen::VectorXd::Constant(1, 0.1), nullptr, Eigen::VectorXd::Constant(1, 0.01));
  EXPECT_TRUE(std::isnan(fit.r_squared(0)));
}

test::FittedTheta model_of(Index n, Index q, Index transitions) {
  test::FittedTheta fit{Eigen::VectorXd::LinSpaced(n * q, 1.0, 2.0), Eigen::MatrixXd::Identity(n * q, n * q),
                        Eigen::VectorXd::Constant(n * q, std::nan("")), n, transitions};
  fit.covariance(0, 0) = 1e12;  // other units
  return fit;
}

TEST(ConfidenceRegion, HasTheQuantilesOfTheTables) {
  EXPECT_NEAR(confidence_region(model_of(1, 3, 25)).limit, 3 * 3.0491, 3e-4);        // F(3, 22)
  EXPECT_NEAR(confidence_region(model_of(1, 3, 3)).limit, 7.8147, 1e-4);             // for L <= q: chi-square(3)
  EXPECT_NEAR(confidence_region(model_of(2, 4, 25), 0.99).limit, 8 * 3.7910, 1e-2);  // F(8, 17)
}

TEST(ConfidenceRegion, RestsOnThePriorWhereTheDataSayNothing) {
  test::FittedTheta fit = model_of(1, 3, 25);
  fit.information.setOnes();
  EXPECT_NEAR(region_degrees_of_freedom(fit), 22.0, 1e-12);
  fit.information = Eigen::Vector3d(0.0, 0.0, 1.0);
  // The mean of F(3, nu) must equal (2 + 22 / 20) / 3: two directions are chi-square, and one has an estimated
  // variance.
  const double nu = region_degrees_of_freedom(fit);
  EXPECT_NEAR(nu / (nu - 2.0), (2.0 + 22.0 / 20.0) / 3.0, 1e-12);
  fit.information.setZero();
  EXPECT_NEAR(confidence_region(fit).limit, 7.8147, 1e-3);
}

TEST(ConfidenceRegion, OfAnUndefinedCovarianceHoldsNothing) {
  test::FittedTheta fit = model_of(1, 3, 25);
  fit.covariance.setConstant(std::nan(""));
  const test::ConfidenceRegion region = confidence_region(fit);
  EXPECT_TRUE(std::isnan(region.limit));
  EXPECT_FALSE(region.contains(fit.theta));
  for (const double level : {0.0, 1.0, -1.0, std::nan("")})
    EXPECT_THROW(confidence_region(fit, level), std::invalid_argument);
}

/// One window with two relations, of 18 and 6 transitions. Least squares lies between the two relations. Every residual
/// is then beyond Tukey's cut-off, and the cost is flat. The Huber optimum lies near the larger group. From there
/// redescending losses reach the fit of that group.
TEST(NonConvexLosses, StartFromTheHuberOptimum) {
  constexpr Index N = 24;
  Eigen::MatrixXd x(1, N + 1), u(1, N + 1);
  std::mt19937_64 generator(5);
  boost::random::normal_distribution<double> noise(0.0, 0.01);
  x(0) = 0.0;
  for (double& value : u.reshaped()) value = noise(generator) > 0.0 ? 1.0 : -1.0;
  for (Index k = 0; k < N; ++k) x(k + 1) = x(k) + (k % 4 != 3 ? 1.0 : -1.0) * u(k) + noise(generator);
  const Trajectory run = test::make_run(x, u);
  const LinearStructure structure{1, 1, false};
  const auto fit = [&](Loss loss) {
    return fit_window(run, 0, structure, test::whole_run(run, loss), Eigen::VectorXd::Constant(1, 0.1), nullptr);
  };
  const double huber = fit(Loss::huber).theta(1);
  EXPECT_LT(fit(Loss::trivial).theta(1), 0.7);
  EXPECT_NEAR(huber, 1.0, 0.1);
  for (const Loss loss : {Loss::cauchy, Loss::tukey, Loss::arctan})
    EXPECT_NEAR(fit(loss).theta(1), 1.0, 0.03) << name_of(loss);
}

}  // namespace
}  // namespace modebank
