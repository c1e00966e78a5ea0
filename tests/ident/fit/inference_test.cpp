#include <cmath>
#include <limits>

#include "ident/fit/fit_window.hpp"
#include "ident/fit/fit_windows.hpp"
#include "ident/fit/global_model.hpp"
#include "ident/fit/scale.hpp"
#include "tests/ident/ident_test_support.hpp"
#include "tests/support/confidence.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using test::confidence_region;
using test::golden_rows;
using test::near;

/// Both implementations solve a well-conditioned problem with O(1) entries in double precision.
constexpr double weighted_fit_tolerance = 1e-11;
/// The golden optima are roots of the estimating equations to about 1e-13.
constexpr double robust_tolerance = 1e-9;

struct WeightedCase {
  explicit WeightedCase(const std::string& name) : json(test::read_golden("ident_inference").at(name)) {
    run = test::make_run(golden_rows(json.at("state")), golden_rows(json.at("input")));
    if (json.contains("weight")) run.weight = golden_rows(json.at("weight"));
    structure = {run.state.rows(), run.input.rows(), run.state.rows() > 1};
    sigma = golden_rows(json.at("sigma"));
  }
  LocalModel fit(const FitOptions& options, const ParameterPrior* prior = nullptr) const {
    return fit_window(run, 0, structure, options, sigma, prior);
  }
  LocalModel fit(Loss loss) const { return fit(test::whole_run(run, loss)); }
  Eigen::MatrixXd expected(const std::string& key) const { return golden_rows(json.at(key)); }
  double number(const std::string& key) const { return json.at(key).get<double>(); }

  nlohmann::json json;
  Trajectory run;
  LinearStructure structure;
  Eigen::VectorXd sigma;
};

constexpr Loss all_losses[] = {Loss::trivial, Loss::huber, Loss::cauchy, Loss::softlone, Loss::tukey, Loss::arctan};

TEST(SampleWeights, LeastSquaresAgreesWithStatsmodelsWls) {
  const WeightedCase c("weighted_least_squares");
  FitOptions options = test::whole_run(c.run, Loss::trivial);
  const LocalModel fit = c.fit(options);
  EXPECT_TRUE(near(fit.theta, c.expected("theta"), weighted_fit_tolerance));
  EXPECT_TRUE(near(fit.covariance, c.expected("covariance"), weighted_fit_tolerance));
  EXPECT_NEAR(fit.noise_variance(0), c.number("noise_variance"), weighted_fit_tolerance);
  EXPECT_TRUE(near(fit.covariance.diagonal().cwiseSqrt(), c.expected("standard_error"), weighted_fit_tolerance));
  EXPECT_TRUE(near(fit.theta.cwiseQuotient(fit.covariance.diagonal().cwiseSqrt()), c.expected("t_value"), 1e-9));
  EXPECT_NEAR(fit.r_squared(0), c.number("r_squared"), weighted_fit_tolerance);
  EXPECT_EQ(fit.transitions, c.json.at("transitions").get<Index>());
  options.covariance = CovarianceKind::sandwich;
  EXPECT_TRUE(near(c.fit(options).covariance, c.expected("hc3"), weighted_fit_tolerance));
}

TEST(SampleWeights, EnterTheGlobalModel) {
  const WeightedCase c("weighted_least_squares");
  const GlobalModel global = fit_global(test::make_recording({c.run}), c.structure);
  EXPECT_TRUE(near(global.theta, c.expected("theta"), weighted_fit_tolerance));
  EXPECT_TRUE(near(global.covariance, c.expected("covariance"), weighted_fit_tolerance));
  EXPECT_NEAR(global.noise_variance()(0), c.number("population_variance"), weighted_fit_tolerance);
  EXPECT_EQ(global.transitions, c.json.at("transitions").get<Index>());
}

TEST(SampleWeights, AreAsManyCopiesOfATransitionForEveryLoss) {
  const WeightedCase c("repeated_transitions");
  for (const Loss loss : {Loss::huber, Loss::cauchy, Loss::softlone, Loss::tukey, Loss::arctan}) {
    const LocalModel fit = c.fit(loss);
    const std::string name(name_of(loss));
    EXPECT_TRUE(near(fit.theta, golden_rows(c.json.at("theta").at(name)), robust_tolerance)) << name;
    EXPECT_NEAR(fit.r_squared(0), c.json.at("r_squared").at(name).get<double>(), robust_tolerance) << name;
    EXPECT_EQ(fit.status, FitStatus::converged);
  }
}

TEST(SampleWeights, ACommonFactorChangesNothing) {
  WeightedCase c("repeated_transitions");
  const ParameterPrior prior{Eigen::Vector3d(-0.2, -0.3, 0.4), Eigen::Vector3d(0.1, 0.2, 0.3)};
  WeightedCase doubled = c, ones = c, none = c;
  doubled.run.weight *= 2.0;
  ones.run.weight = Eigen::VectorXd::Constant(c.run.samples(), 2.0);
  none.run.weight.resize(0);
  for (const Loss loss : all_losses)
    for (const CovarianceKind kind : {CovarianceKind::model, CovarianceKind::sandwich}) {
      FitOptions options = test::whole_run(c.run, loss);
      options.covariance = kind;
      for (const auto& [a, b] : {std::pair{&c, &doubled}, {&none, &ones}}) {
        const LocalModel one = a->fit(options, &prior), two = b->fit(options, &prior);
        EXPECT_TRUE(near(two.theta, one.theta, 1e-12)) << name_of(loss);
        EXPECT_TRUE(near(two.covariance, one.covariance, 1e-12)) << name_of(loss);
        EXPECT_TRUE(near(two.noise_variance, one.noise_variance, 1e-12)) << name_of(loss);
      }
    }
}

TEST(SampleWeights, OfZeroLeaveATransitionOut) {
  WeightedCase c("repeated_transitions");
  c.run.weight.setOnes();
  c.run.weight(12) = 0.0;
  WeightedCase missing = c;
  missing.run.weight.resize(0);
  // Transition 11 ends in sample 12. A NaN state there would also affect transition 12; a NaN input affects only one.
  missing.run.input(0, 11) = std::nan("");
  for (const Loss loss : all_losses) {
    const LocalModel zero = c.fit(loss), left_out = missing.fit(loss);
    EXPECT_TRUE(near(zero.theta, left_out.theta, 1e-12)) << name_of(loss);
    EXPECT_TRUE(near(zero.covariance, left_out.covariance, 1e-12)) << name_of(loss);
    EXPECT_EQ(zero.transitions, 29);
  }
}

TEST(SampleWeights, WeighTheMedians) {
  const Eigen::VectorXd values{{3.0, -1.0, 7.0, 2.0}}, copies{{3.0, 3.0, -1.0, 7.0, 7.0, 7.0, 2.0}};
  EXPECT_EQ(normalised_mad(values, Eigen::VectorXd{{2.0, 1.0, 3.0, 1.0}}), normalised_mad(copies));
  EXPECT_EQ(normalised_mad(values, Eigen::VectorXd::Constant(4, 0.3)), normalised_mad(values));
  Trajectory run = WeightedCase("repeated_transitions").run;
  const auto fits = [&] { return fit_windows(test::make_recording({run}), FitOptions{}); };
  run.weight *= 5.0;
  const WindowFits five = fits();
  run.weight /= 5.0;
  EXPECT_TRUE(near(five.parameters, fits().parameters, 1e-12));
  EXPECT_TRUE(near(five.prior_sd, fits().prior_sd, 1e-12));
}

TEST(SampleWeights, MustBeOnePerSampleAndNotNegative) {
  WeightedCase c("repeated_transitions");
  for (const double bad : {-1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    c.run.weight(3) = bad;
    EXPECT_THROW(c.fit(Loss::huber), std::invalid_argument);
    EXPECT_THROW(fit_global(test::make_recording({c.run}), c.structure), std::invalid_argument);
  }
  c.run.weight.setOnes(5);
  EXPECT_THROW(c.fit(Loss::huber), std::invalid_argument);
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
