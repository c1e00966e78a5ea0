#include "ident/fit/loss.hpp"

#include <ceres/gradient_checker.h>

#include <boost/math/distributions/normal.hpp>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <functional>

#include "ident/fit/minimise.hpp"
#include "ident/fit/residuals.hpp"
#include "tests/ident/ident_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using test::near;

double gaussian_mean(const std::function<double(double)>& f, double kink) {
  const boost::math::normal density;
  const auto integrand = [&](double z) { return 2.0 * f(z) * boost::math::pdf(density, z); };
  using Quadrature = boost::math::quadrature::gauss_kronrod<double, 61>;
  return Quadrature::integrate(integrand, 0.0, kink) + Quadrature::integrate(integrand, kink, 12.0);
}

class EachLoss : public ::testing::TestWithParam<Loss> {};

TEST_P(EachLoss, DefaultScaleHasNinetyFivePercentEfficiency) {
  const RobustLoss loss(GetParam(), 0.0);
  // Efficiency of an M-estimate of location: (E psi')^2 / E psi^2 (Huber 1981).
  const auto psi = [&](double z) { return loss(z * z).weight * z; };
  const auto slope = [&](double z) { return loss(z * z).weight + 2.0 * loss(z * z).curvature * z * z; };
  const double mean_slope = gaussian_mean(slope, loss.scale());
  const double efficiency =
      mean_slope * mean_slope / gaussian_mean([&](double z) { return psi(z) * psi(z); }, loss.scale());
  // The published constants have three decimals.
  EXPECT_NEAR(efficiency, GetParam() == Loss::trivial ? 1.0 : 0.95, 2e-4);
}

TEST_P(EachLoss, DerivativesAgreeWithDifferences) {
  const RobustLoss loss(GetParam(), 1.3);
  constexpr double h = 1e-5, difference_tolerance = 1e-8;
  for (const double s : {0.0 + h, 0.4, 1.1, 2.5, 9.0}) {
    EXPECT_NEAR(loss(s).weight, (loss(s + h).rho - loss(s - h).rho) / (2 * h), difference_tolerance) << "s = " << s;
    EXPECT_NEAR(loss(s).curvature, (loss(s + h).weight - loss(s - h).weight) / (2 * h), difference_tolerance)
        << "s = " << s;
  }
}

INSTANTIATE_TEST_SUITE_P(Losses, EachLoss,
                         ::testing::Values(Loss::trivial, Loss::huber, Loss::cauchy, Loss::softlone, Loss::tukey,
                                           Loss::arctan),
                         [](const auto& instance) { return std::string(name_of(instance.param)); });

TEST(GaussianConsistency, HuberHasItsClosedForm) {
  // By Stein's lemma, E[psi(z) z] = E[psi'(z)], which is 2 Phi(c) - 1 for one state.
  const boost::math::normal normal;
  EXPECT_NEAR(gaussian_consistency(RobustLoss(Loss::huber, 0.0), 1), 2 * boost::math::cdf(normal, 1.345) - 1, 1e-12);
  EXPECT_EQ(gaussian_consistency(RobustLoss(Loss::trivial, 0.0), 3), 1.0);
}

TEST(GaussianConsistency, SeveralStatesAgreeWithDraws) {
  std::mt19937_64 generator(4);
  boost::random::normal_distribution<double> normal;
  const RobustLoss loss(Loss::cauchy, 0.0);
  constexpr int draws = 200000;
  double sum = 0.0;
  for (int i = 0; i < draws; ++i) {
    double s = 0.0;
    for (int j = 0; j < 3; ++j) s += std::pow(normal(generator), 2);
    sum += loss(s).weight * s / 3;
  }
  constexpr double four_standard_errors = 3e-3;
  EXPECT_NEAR(gaussian_consistency(loss, 3), sum / draws, four_standard_errors);
}

TEST(RobustLossScale, MustBePositive) {
  EXPECT_THROW(RobustLoss(Loss::huber, -1.0), std::invalid_argument);
  EXPECT_THROW(RobustLoss(Loss::huber, std::nan("")), std::invalid_argument);
}

WhitenedProblem example_problem(const ParameterPrior* prior) {
  const auto golden = test::golden_fit("two_states");
  const Trajectory run = test::make_run(test::golden_rows(golden.at("state")), test::golden_rows(golden.at("input")));
  const Transitions t = stack_transitions(run, 0, run.transitions(), {2, 1, true});
  return whiten(t, decompose(t.regressors, excitation_tolerance), Eigen::Vector2d(0.06, 0.14), prior);
}

const ParameterPrior example_prior{Eigen::VectorXd::Constant(8, 0.1), Eigen::VectorXd::LinSpaced(8, 0.2, 2.0)};

TEST(LinearResidual, JacobianPassesTheGradientChecker) {
  const WhitenedProblem problem = example_problem(&example_prior);
  const Eigen::VectorXd z = Eigen::VectorXd::LinSpaced(problem.unknowns(), -1.0, 1.0);
  const double* blocks[] = {z.data()};
  ceres::NumericDiffOptions numeric;
  constexpr double relative_precision = 1e-8;  // accuracy of central differences of a linear function
  for (const auto& [first, count] : {std::pair<Index, Index>{6, 2}, {problem.sample_rows(), problem.prior_rows()}}) {
    const LinearResidual residual(problem, first, count);
    ceres::GradientChecker checker(&residual, static_cast<std::vector<const ceres::Manifold*>*>(nullptr), numeric);
    ceres::GradientChecker::ProbeResults results;
    EXPECT_TRUE(checker.Probe(blocks, relative_precision, &results)) << results.error_log;
  }
}

TEST(WhitenedProblem, IsTheStatedLeastSquaresProblem) {
  const WhitenedProblem problem = example_problem(&example_prior);
  constexpr double rounding = 1e-12;
  EXPECT_TRUE(near(problem.J.transpose() * problem.J, Eigen::MatrixXd::Identity(8, 8), rounding));
  EXPECT_TRUE(near(problem.J.transpose() * problem.b, Eigen::VectorXd::Zero(8), 1e-10));
  const Eigen::VectorXd z = Eigen::VectorXd::LinSpaced(8, -2.0, 3.0);
  const Eigen::VectorXd r = problem.b - problem.J * z, theta = problem.theta(z);
  const Eigen::VectorXd prior_residual = (example_prior.mean - theta).cwiseQuotient(example_prior.sd);
  EXPECT_TRUE(near(r.tail(8), prior_residual, 1e-10));
  const auto golden = test::golden_fit("two_states");
  const Trajectory run = test::make_run(test::golden_rows(golden.at("state")), test::golden_rows(golden.at("input")));
  const LinearModel model = unpack({2, 1, true}, theta);
  for (const Index k : {0, 17, 39}) {
    const Eigen::Vector2d error = run.state.col(k + 1) - model.next(run.state.col(k), run.input.col(k));
    EXPECT_TRUE(near(r.segment(2 * k, 2), error.cwiseQuotient(Eigen::Vector2d(0.06, 0.14)), 1e-10)) << "sample " << k;
  }
}

TEST(Hessian, AgreesWithDifferencesOfTheGradient) {
  const WhitenedProblem problem = example_problem(&example_prior);
  const Eigen::VectorXd z = Eigen::VectorXd::LinSpaced(8, -1.0, 1.0);
  constexpr double h = 1e-6, difference_tolerance = 1e-6;
  for (const Loss kind : {Loss::cauchy, Loss::softlone, Loss::arctan}) {
    const RobustLoss loss(kind, 0.0);
    Eigen::MatrixXd differences(8, 8);
    for (Index j = 0; j < 8; ++j) {
      const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(8, j);
      differences.col(j) = (gradient(problem, evaluate(problem, loss, z + step)) -
                            gradient(problem, evaluate(problem, loss, z - step))) /
                           (2 * h);
    }
    EXPECT_TRUE(near(hessian(problem, evaluate(problem, loss, z)), differences, difference_tolerance)) << name_of(kind);
  }
}

}  // namespace
}  // namespace modebank
