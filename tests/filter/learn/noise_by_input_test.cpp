// Noise that depends on state and input: the factor on every mode's Q, and whether training runs accept the factor.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "filter/judge/evaluate.hpp"
#include "filter/judge/horizon.hpp"
#include "filter/learn/competitors/competitors.hpp"
#include "filter/learn/from_mixture/bank.hpp"
#include "filter/learn/left_out/folds.hpp"
#include "filter/learn/likelihood/maximum_likelihood.hpp"
#include "filter/learn/switching/regression.hpp"
#include "filter/step/likelihood_gradient.hpp"
#include "tests/filter/free_run_test_support.hpp"
#include "tests/filter/learn/learn_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::near;

/// Runs of x[k+1] = 0.9 x[k] + 0.1 u[k] + sd w; `rough` switches now and then.
Recording runs_of(const std::function<double(double x, double u, bool rough)>& sd, unsigned seed = 1, Index runs = 6,
                  Index samples = 500) {
  std::mt19937_64 generator(seed);
  boost::random::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  Recording recording = test::empty_recording(1, 1);
  for (Index r = 0; r < runs; ++r) {
    MatrixXd x = MatrixXd::Zero(1, samples), u(1, samples);
    bool rough = false;
    for (Index k = 0; k < samples; ++k) {
      u(k) = k % 20 == 0 ? 3.0 * (uniform(generator) - 0.5) : u(k - 1);
      rough = rough != (uniform(generator) < 0.03);
      if (k + 1 < samples) x(k + 1) = 0.9 * x(k) + 0.1 * u(k) + sd(x(k), u(k), rough) * normal(generator);
    }
    test::add_run(recording, x, u);
  }
  return recording;
}

double follows_input(double, double u, bool) { return 0.01 + 0.03 * std::abs(u); }
double follows_state(double x, double, bool) { return 0.01 + 0.04 * std::abs(x); }

/// One state. Modes have A = -0.2, -0.5, ...; all other coefficients are 0.1.
Bank bank_of(const Recording& recording, const LinearStructure& s, double R, Index modes) {
  Bank bank = bank_frame(recording, s, MatrixXd::Constant(1, 1, R));
  for (Index j = 0; j < modes; ++j) {
    VectorXd theta = VectorXd::Constant(s.parameters(), 0.1);
    theta(0) = -0.2 - 0.3 * static_cast<double>(j);
    bank.modes.push_back(make_mode(s, theta, MatrixXd::Constant(1, 1, j == 0 ? 4e-4 : 4e-3), {}, {}, 1.0));
  }
  set_mode_sequence(bank, TransitionMatrix::sticky(modes, 0.9));
  return bank;
}

/// One exactly measured mode. Every density must be that of a residual with covariance f Q.
TEST(NoiseFactor, MultipliesTheCovarianceOfEveryStep) {
  const Recording recording = runs_of(follows_input, 3, 1, 60);
  const LinearStructure s = test::structure_of(recording);
  Bank bank = bank_of(recording, s, 0.0, 1);
  bank.noise_factor = {MatrixXd{{2.0, 0.0}, {0.0, 1.5}}, Eigen::Vector2d(0.4, 1.1), -0.2};
  const Trajectory& run = recording.runs.front();
  const VectorXd is = log_densities(bank, run, {});
  for (Index k = 1; k < run.samples(); ++k) {
    const double x = run.state(k - 1), u = run.input(k - 1);
    const double log_f =
        std::clamp(0.4 * std::log(std::abs(2.0 * x) + 0.1) + 1.1 * std::log(std::abs(1.5 * u) + 0.1) + 0.2,
                   -std::log(5.0), std::log(5.0));
    const double Q = 4e-4 * std::exp(log_f), e = run.state(k) - (0.8 * x + 0.1 * u);
    EXPECT_NEAR(is(k), -0.5 * (std::log(2.0 * std::numbers::pi * Q) + e * e / Q), 1e-9) << k;
  }
}

/// With exactly measured states, the filter's likelihood follows from rows divided by the square root of their factor.
/// Half the logarithm of each factor is subtracted.
TEST(NoiseFactor, LikelihoodIsThatOfRowsOverTheirFactor) {
  const Recording recording = runs_of(follows_input, 4, 3, 200);
  const LinearStructure s{1, 1, true, 2, 2};
  Bank bank = bank_of(recording, s, 0.0, 3);
  bank.noise_factor = fit_noise_factor(recording, s);
  ASSERT_FALSE(bank.noise_factor.empty());
  const VectorXd rows =
      predictive_log_densities(gather_training_transitions(recording, s, bank.noise_factor), switching_model(bank));
  EXPECT_NEAR(training_log_likelihood(bank, recording, {}), rows.sum(), 1e-5 * std::abs(rows.sum()));
}

/// A constant input gives a constant factor. The filter's results must then equal those for Q times this factor.
TEST(NoiseFactor, ThatIsConstantIsAsAnotherQ) {
  Recording recording = runs_of(follows_input, 5, 1, 150);
  Trajectory& run = recording.runs.front();
  run.input.setOnes();
  const double c = 2.5;
  Bank plain = bank_of(recording, {1, 1, true, 2, 1}, 1e-3, 2), with_factor = plain;
  for (Mode& mode : plain.modes) mode.Q *= c;
  with_factor.noise_factor = {MatrixXd{{0.0, 0.0, 1.0}}, VectorXd::Ones(1), std::log(1.1) - std::log(c)};
  const RunEvaluation expected = evaluate_run(plain, run, {}), is = evaluate_run(with_factor, run, {});
  EXPECT_TRUE(near(is.log_density.tail(140), expected.log_density.tail(140), 1e-8));
  EXPECT_TRUE(near(is.mode_probability, expected.mode_probability, 1e-8));
  EXPECT_EQ(mode_sequence(with_factor, run, {}), mode_sequence(plain, run, {}));
}

TEST(NoiseFactor, OfSamplePathsIsThatOfEachPathsOwnState) {
  const Recording recording = runs_of(follows_input, 6, 1, 60);
  Bank bank = bank_of(recording, test::structure_of(recording), 0.0, 1);
  bank.noise_factor = {MatrixXd{{0.0, 1.0}}, VectorXd::Ones(1), 0.3};
  Trajectory run;
  run.state = Eigen::RowVector2d(0.2, 0.25);
  run.input = Eigen::RowVector2d(1.4, 0.0);
  const FreeRun paths = free_run(test::with_paths(bank), run, {}, test::after(1, 40'000));
  const double Q = 4e-4 * std::exp(std::log(1.5) - 0.3), e = 0.25 - paths.mean(0, 1);
  EXPECT_NEAR(std::pow(paths.deviation(0, 1), 2), Q, 0.03 * Q);  // tolerance: four standard errors
  EXPECT_NEAR(paths.log_density(1), -0.5 * (std::log(2.0 * std::numbers::pi * Q) + e * e / Q), 1e-9);
}

TEST(NoiseFactor, IsRefusedWhereNothingCanHaveIt) {
  const Recording recording = runs_of(follows_input, 7, 1, 60);
  Bank bank = bank_of(recording, test::structure_of(recording), 0.0, 2);
  EXPECT_TRUE(has_likelihood_gradient(bank, {}));
  bank.noise_factor = {MatrixXd::Ones(1, 2), VectorXd::Ones(1), 0.0};
  EXPECT_FALSE(has_likelihood_gradient(bank, {}));
  EXPECT_THROW(log_likelihood(bank, recording.runs[0], {.variant = FilterVariant::salvi2025}), std::invalid_argument);
  for (const NoiseFactor& wrong : {NoiseFactor{MatrixXd::Ones(1, 3), VectorXd::Ones(1), 0.0},
                                   NoiseFactor{MatrixXd::Ones(1, 2), VectorXd::Constant(1, NAN), 0.0}}) {
    bank.noise_factor = wrong;
    EXPECT_THROW(validate(bank), std::invalid_argument);
  }
}

/// Correlation of log f with the true log variance, over a grid of state and input.
double likeness(const NoiseFactor& factor, double (*sd)(double, double, bool)) {
  MatrixXd logs(29 * 29, 2);
  for (Index i = 0; i < logs.rows(); ++i) {
    const double x = 0.1 * static_cast<double>(i % 29 - 14), u = 0.1 * static_cast<double>(i / 29 - 14);
    logs.row(i) << factor.log_at(VectorXd::Constant(1, x), VectorXd::Constant(1, u)), 2.0 * std::log(sd(x, u, false));
  }
  logs.rowwise() -= logs.colwise().mean().eval();
  logs.colwise().normalize();
  return logs.col(0).dot(logs.col(1));
}

TEST(FindNoiseFactor, FindsNoiseThatFollowsAnInputOrTheState) {
  for (const unsigned seed : {1u, 2u, 3u})
    for (const auto sd : {follows_input, follows_state}) {
      const Recording recording = runs_of(sd, seed);
      const FoundNoiseFactor found = find_noise_factor(recording, test::structure_of(recording), 6, 1);
      ASSERT_FALSE(found.factor.empty()) << seed << ": " << found.gain << " +- " << found.standard_error;
      EXPECT_GT(likeness(found.factor, sd), 0.9);
    }
}

TEST(FindNoiseFactor, FindsNoneInConstantSwitchingOrRoundedNoise) {
  const auto constant = [](double, double, bool) { return 0.03; };
  const auto switching = [](double, double, bool rough) { return rough ? 0.06 : 0.01; };
  const LinearStructure s{1, 1, false};
  for (const unsigned seed : {1u, 2u, 3u}) {
    EXPECT_TRUE(find_noise_factor(runs_of(constant, seed), s, 6, 1).factor.empty());
    EXPECT_TRUE(find_noise_factor(runs_of(switching, seed), s, 6, 1).factor.empty());
  }
  Recording rounded = runs_of(follows_input);
  rounded.quantum = VectorXd::Constant(1, 1e-3);
  EXPECT_TRUE(std::isnan(find_noise_factor(rounded, s, 6, 1).gain)) << "not asked";
}

/// Q is of rows divided by their factor, R is negligible, and runs that judge a fit did not teach its factor.
TEST(LearnRefinedBank, HasTheFactorOfItsOwnTrainingRuns) {
  const Recording recording = runs_of(follows_input, 9, 4, 250);
  WindowFits fits = test::windows_of(recording, 20, 10);
  const MixtureResult one = test::mixture_of(fits, MatrixXd::Ones(1, fits.count()));
  BankOptions options;
  options.em.noise_by_input = true;
  const Refinement refined = learn_refined_bank(recording, fits, one, options, MatrixXd::Zero(1, 1), {});
  EXPECT_EQ(refined.bank.noise_factor.weights, fit_noise_factor(recording, fits.structure).weights);
  EXPECT_EQ(refined.bank.R_standard_error.size(), 0);
  EXPECT_TRUE(refined.bank.modes.front().standard_error.allFinite());
  const std::vector<ValidationSplit> splits = validation_splits(recording, options.em.folds);
  ASSERT_EQ(refined.of_splits.size(), splits.size());
  for (std::size_t s = 0; s < splits.size(); ++s)
    EXPECT_EQ(refined.of_splits[s].noise_factor.weights, fit_noise_factor(splits[s].training, fits.structure).weights);
  options.em.folds = 1;  // no run is left out: two scores that are NaN accept nothing
  const Bank without = learn_refined_bank(recording, fits, one, options, MatrixXd::Zero(1, 1), {}).bank;
  EXPECT_TRUE(without.noise_factor.empty());
  EXPECT_GT(training_log_likelihood(refined.bank, recording, {}), training_log_likelihood(without, recording, {}));
}

/// The result must not depend on the units of states and inputs.
TEST(FindNoiseFactor, DoesNotDependOnUnits) {
  const Recording recording = runs_of(follows_input);
  Recording other = recording;
  for (Trajectory& run : other.runs) {
    run.state *= 1e3;
    run.input *= 1e-2;
  }
  const LinearStructure s = test::structure_of(recording);
  const NoiseFactor a = fit_noise_factor(recording, s), b = fit_noise_factor(other, s);
  for (const double x : {-0.4, 0.1, 0.7})
    for (const double u : {-1.2, 0.0, 0.5})
      EXPECT_NEAR(a.log_at(VectorXd::Constant(1, x), VectorXd::Constant(1, u)),
                  b.log_at(VectorXd::Constant(1, 1e3 * x), VectorXd::Constant(1, 1e-2 * u)), 1e-6);
}

}  // namespace
}  // namespace modebank
