// The competitor with one nonlinear motion, and filters of a bank with terms.
#include <gtest/gtest.h>

#include <cmath>

#include "filter/judge/evaluate.hpp"
#include "filter/judge/horizon.hpp"
#include "filter/step/bank_filter.hpp"
#include "ident/data/stretch.hpp"
#include "tests/filter/free_run_test_support.hpp"
#include "tests/filter/learn/learn_test_support.hpp"

namespace modebank {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// x[k+1] = .8 x[k] + .2 u[k] + .5 max(0, u[k] - .3) - .1 x[k]^2.
struct Bent {
  LinearStructure structure{1, 1};
  MotionTerms terms;
  MatrixXd bend = MatrixXd(1, 2);
  double sd = 0.02;

  Bent() {
    terms.direction = MatrixXd::Identity(2, 2);
    terms.low.setConstant(2, -5.0);
    terms.high.setConstant(2, 5.0);
    terms.unit.setOnes(2);
    terms.terms = {{TermKind::hinge, {1}, 0.3}, {TermKind::product, {0, 0}}};
    bend << 0.5, -0.1;
  }
  double next(double x, double u) const { return 0.8 * x + 0.2 * u + 0.5 * std::max(0.0, u - 0.3) - 0.1 * x * x; }

  Bank bank() const {
    Bank bank = one_mode_bank(structure, Eigen::Vector2d(-0.2, 0.2), VectorXd::Constant(1, sd * sd));
    bank.modes.front().bend = bend;
    bank.state_names = {"x0"};
    bank.input_names = {"u0"};
    bank.dt_s = 0.1;
    bank.terms = terms;
    return bank;
  }

  Recording runs(Index count, std::uint64_t seed) const {
    Recording recording = test::simulated_runs(count, 400, seed, [&](const auto& x, const auto& u, Index k, double w) {
      return next(x(k), 0.6 * u(k)) + sd * w;
    });
    for (Trajectory& run : recording.runs) run.input *= 0.6;
    return recording;
  }
};

TEST(BankWithTerms, PredictsByItsFunction) {
  const Bent bent;
  Bank wrong = bent.bank();
  wrong.modes.front().bend = MatrixXd::Ones(1, 3);
  EXPECT_THROW(BankFilter(wrong, FilterOptions()), std::invalid_argument) << "coefficients of other sizes";
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
  const FreeRun said = free_run(bent.bank(), run, {}, test::after(5)),
                paths = free_run(test::with_paths(bent.bank()), stretch(run, 0, 25), {}, test::after(5, 4000));
  double x = run.state(0, 4), variance = 0.0;
  for (Index k = 5; k < 25; ++k) {
    variance = std::pow(0.8 - 0.2 * x, 2) * variance + bent.sd * bent.sd;
    x = bent.next(x, run.input(0, k - 1));
    ASSERT_NEAR(said.mean(0, k), x, 1e-12);
    ASSERT_NEAR(said.deviation(0, k), std::sqrt(variance), 1e-12);
    EXPECT_NEAR(paths.mean(0, k), x, 5.0 * std::sqrt(variance) / 60.0);
  }
}

TEST(LearnNonlinear, RecoversCoefficientsAndIsReadyForLargerErrors) {
  const Bent bent;
  const Bank bank = learn_nonlinear(bent.runs(8, 3), bent.structure, bent.terms, RefineOptions());
  const Mode& mode = bank.modes.front();
  const Eigen::Vector2d theta(-0.2, 0.2);
  for (Index i = 0; i < 2; ++i) {
    EXPECT_LT(std::abs(bank.theta(0)(i) - theta(i)), 4.0 * mode.standard_error(i)) << i;
    EXPECT_LT(std::abs(mode.bend(0, i) - bent.bend(0, i)), 4.0 * mode.bend_standard_error(0, i)) << i;
    EXPECT_LT(mode.bend_standard_error(0, i), 0.05);
  }
  // One noise level is wider than the training runs. The true density scores -ln(sd sqrt(2 pi e)). If errors are three
  // times as large as in training, the noise level from training would lose (9 - 1) / 2 - ln 3 = 2.9 nats.
  const auto lost = [&](double times) {  // nats per sample, on runs with other noise
    Bent other = bent;
    other.sd *= times;
    double sum = 0.0;
    for (const Trajectory& run : other.runs(4, 11).runs) sum += log_likelihood(bank, run, FilterOptions());
    return -std::log(other.sd * std::sqrt(2.0 * M_PI * std::exp(1.0))) - sum / (4.0 * 399.0);
  };
  EXPECT_NEAR(lost(1.0), 0.0, 0.03) << "where no error is large it costs its share";
  EXPECT_LT(lost(3.0), 0.3);
}

TEST(LearnNonlinear, TakesLagsAndDelaysAsTheyAre) {
  Bent bent;
  bent.structure = {1, 1, true, 2, 2, 0};
  MotionTerms terms = bent.terms;
  terms.direction = MatrixXd::Zero(5, 2);
  terms.direction(0, 0) = terms.direction(3, 1) = 1.0;  // the previous sample of u is the acting input
  const Recording recording = bent.runs(8, 4);
  const Bank bank = learn_nonlinear(recording, bent.structure, terms, RefineOptions());
  const Trajectory& run = recording.runs.front();
  const RunEvaluation said = evaluate_run(bank, run, FilterOptions());
  for (Index k = 3; k < run.samples(); ++k)
    ASSERT_NEAR(said.prediction(0, k), bent.next(run.state(0, k - 1), run.input(0, k - 1)), 0.02);
}

}  // namespace
}  // namespace modebank
