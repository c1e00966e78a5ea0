// The competitor with one nonlinear motion, and filters of a bank with terms.
#include <gtest/gtest.h>

#include <boost/random/normal_distribution.hpp>
#include <cmath>
#include <random>

#include "filter/judge/evaluate.hpp"
#include "filter/judge/free_run.hpp"
#include "filter/step/bank_filter.hpp"
#include "ident/data/stretch.hpp"
#include "tests/filter/free_run_test_support.hpp"
#include "tests/filter/learn/learn_test_support.hpp"

namespace modebank {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// x[k+1] = .8 x[k] + .2 u[k] + .5 max(0, u[k] - .3) - .1 x[k]^2, with one state and one input.
struct Bent {
  LinearStructure structure{1, 1};
  MotionTerms terms;
  MatrixXd bend = MatrixXd(1, 2);
  double sd = 0.02;

  Bent() {
    terms.direction = MatrixXd::Identity(2, 2);
    terms.low = Eigen::Vector2d(-5.0, -5.0);
    terms.high = Eigen::Vector2d(5.0, 5.0);
    terms.unit = Eigen::Vector2d(1.0, 1.0);
    terms.terms = {{TermKind::hinge, {1}, 0.3}, {TermKind::product, {0, 0}}};
    bend << 0.5, -0.1;
  }
  double next(double x, double u) const { return 0.8 * x + 0.2 * u + 0.5 * std::max(0.0, u - 0.3) - 0.1 * x * x; }
  double slope(double x) const { return 0.8 - 0.2 * x; }

  Bank bank() const {
    Bank bank;
    bank.structure = structure;
    Mode mode;
    mode.model = unpack(structure, Eigen::Vector2d(-0.2, 0.2));
    mode.Q = MatrixXd::Constant(1, 1, sd * sd);
    mode.bend = bend;
    bank.modes = {mode};
    bank.C = MatrixXd::Identity(1, 1);
    bank.R = MatrixXd::Zero(1, 1);
    bank.initial_probability = VectorXd::Ones(1);
    bank.state_names = {"x0"};
    bank.input_names = {"u0"};
    bank.dt_s = 0.1;
    bank.terms = terms;
    return bank;
  }

  Recording runs(Index count, std::uint64_t seed) const {
    std::mt19937_64 generator(seed);
    boost::random::normal_distribution<double> normal;
    Recording recording = test::empty_recording(1, 1);
    for (Index r = 0; r < count; ++r) {
      MatrixXd x = MatrixXd::Zero(1, 400), u(1, 400);
      for (double& value : u.reshaped()) value = 0.6 * normal(generator);
      for (Index k = 0; k + 1 < 400; ++k) x(0, k + 1) = next(x(0, k), u(0, k)) + sd * normal(generator);
      test::add_run(recording, x, u);
    }
    return recording;
  }
};

TEST(BankWithTerms, PredictsByItsFunction) {
  const Bent bent;
  const Trajectory run = bent.runs(1, 1).runs.front();
  const RunEvaluation said = evaluate_run(bent.bank(), run, FilterOptions());
  for (Index k = 1; k < run.samples(); ++k) {
    ASSERT_NEAR(said.prediction(0, k), bent.next(run.state(0, k - 1), run.input(0, k - 1)), 1e-12);
    ASSERT_NEAR(said.innovation_covariance(0, k), bent.sd * bent.sd, 1e-15);
  }
}

TEST(BankWithTerms, FreeRunsFollowTheFunctionAndItsSlope) {
  const Bent bent;
  const Trajectory run = bent.runs(1, 2).runs.front();
  const FreeRun said = free_run(bent.bank(), run, {}, test::after(5));
  double x = run.state(0, 4), variance = 0.0;
  for (Index k = 5; k < 25; ++k) {
    variance = bent.slope(x) * bent.slope(x) * variance + bent.sd * bent.sd;
    x = bent.next(x, run.input(0, k - 1));
    ASSERT_NEAR(said.mean(0, k), x, 1e-12);
    ASSERT_NEAR(said.deviation(0, k), std::sqrt(variance), 1e-12);
  }
}

TEST(BankWithTerms, SamplePathsHaveTheMeanOfItsMoments) {
  const Bent bent;
  const Trajectory run = stretch(bent.runs(1, 2).runs.front(), 0, 15);
  const FreeRun moments = free_run(bent.bank(), run, {}, test::after(5)),
                paths = free_run(test::with_paths(bent.bank()), run, {}, test::after(5, 4000));
  for (Index k = 5; k < 15; ++k)
    EXPECT_NEAR(paths.mean(0, k), moments.mean(0, k), 5.0 * moments.deviation(0, k) / 60.0);
}

TEST(BankWithTerms, RefusesCoefficientsOfOtherSizes) {
  Bank bank = Bent().bank();
  bank.modes.front().bend = MatrixXd::Ones(1, 3);
  EXPECT_THROW(BankFilter(bank, FilterOptions()), std::invalid_argument);
}

TEST(LearnNonlinear, RecoversCoefficientsWithinTheirErrors) {
  const Bent bent;
  const Bank bank = learn_nonlinear(bent.runs(8, 3), bent.structure, bent.terms, RefineOptions());
  const Mode& mode = bank.modes.front();
  const Eigen::Vector2d theta(-0.2, 0.2);
  for (Index i = 0; i < 2; ++i) {
    EXPECT_LT(std::abs(bank.theta(0)(i) - theta(i)), 4.0 * mode.standard_error(i)) << i;
    EXPECT_LT(std::abs(mode.bend(0, i) - bent.bend(0, i)), 4.0 * mode.bend_standard_error(0, i)) << i;
    EXPECT_LT(mode.bend_standard_error(0, i), 0.05);
  }
}

/// Log score [nats/sample] of a bank on runs with different noise. The bank is learned from runs like `like`.
double score_on(double sd, const Bent& like) {
  const Bank bank = learn_nonlinear(like.runs(8, 3), like.structure, like.terms, RefineOptions());
  Bent other = like;
  other.sd = sd;
  double sum = 0.0, samples = 0.0;
  for (const Trajectory& run : other.runs(4, 11).runs) {
    const VectorXd densities = evaluate_run(bank, run, FilterOptions()).log_density;
    sum += densities.tail(densities.size() - 1).sum();
    samples += static_cast<double>(densities.size() - 1);
  }
  return sum / samples;
}

/// The true density scores -ln(sd sqrt(2 pi e)). If errors are three times as large as in training, the noise level
/// from training would lose (9 - 1) / 2 - ln 3 = 2.9 nats.
TEST(LearnNonlinear, OneLevelIsWiderThanTheTrainingRuns) {
  const Bent bent;
  const auto truth = [](double sd) { return -std::log(sd * std::sqrt(2.0 * M_PI * std::exp(1.0))); };
  EXPECT_NEAR(score_on(bent.sd, bent), truth(bent.sd), 0.03) << "where no error is large it costs its share";
  EXPECT_GT(score_on(3.0 * bent.sd, bent), truth(3.0 * bent.sd) - 0.3);
}

TEST(LearnNonlinear, TakesLagsAndDelaysAsTheyAre) {
  Bent bent;
  bent.structure = {1, 1, true, 2, 2, 0};
  MotionTerms terms = bent.terms;
  terms.direction = MatrixXd::Zero(5, 2);
  terms.direction(0, 0) = terms.direction(3, 1) = 1.0;  // the previous sample of u is the acting input
  const Recording recording = bent.runs(8, 4);
  const Bank bank = learn_nonlinear(recording, bent.structure, terms, RefineOptions());
  const RunEvaluation said = evaluate_run(bank, recording.runs.front(), FilterOptions());
  const Trajectory& run = recording.runs.front();
  for (Index k = 3; k < run.samples(); ++k)
    ASSERT_NEAR(said.prediction(0, k), bent.next(run.state(0, k - 1), run.input(0, k - 1)), 0.02);
}

}  // namespace
}  // namespace modebank
