// R by the filter's likelihood, and refinement with measurement noise: theta, Q, R and T together.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "filter/judge/evaluate.hpp"
#include "filter/learn/refine/cross_validation.hpp"
#include "tests/filter/learn/refine_recovery.hpp"

namespace modebank {
namespace {

/// Rounded runs of two modes. With 1 fold the fit runs to convergence. With more folds cross-validation stops the fit.
class RefineRounded : public testing::TestWithParam<Index> {
 protected:
  Bank truth = test::true_scalar(1.0);
  Refinement refined(double quantum) const {
    Recording recording = test::simulated_recording(truth, 6, 600, 11);
    for (Trajectory& run : recording.runs) run.state = ((run.state / quantum).array().round() * quantum).matrix();
    recording.quantum.setConstant(1, quantum);
    return test::refine_blurred(truth, recording, GetParam());
  }
};

/// Noise and rounding of equal size. R must be that of both.
TEST_P(RefineRounded, FindsNoiseBesideRounding) {
  const double quantum = 0.3;
  const Refinement found = refined(quantum);
  truth.R(0, 0) += quantum * quantum / 12.0;
  EXPECT_GT(found.measurement.iterations, 0);
  for (const double z : test::z_values(found.bank, truth)) EXPECT_LT(std::abs(z), 3.0);
  EXPECT_LT(found.bank.R_standard_error(0, 0), 0.3 * truth.R(0, 0));
}

/// Rounding alone must give no R beside its own.
TEST_P(RefineRounded, TakesRoundingForNoNoise) {
  const double quantum = 0.2;
  truth.R.setZero();
  const Refinement found = refined(quantum);
  EXPECT_GT(found.measurement.starts, 0);
  EXPECT_GT(found.measurement.iterations, 0);
  EXPECT_GE(found.bank.R(0, 0), quantum * quantum / 12.0);
  EXPECT_LT(found.bank.R(0, 0), 1.1 * quantum * quantum / 12.0);
}

INSTANTIATE_TEST_SUITE_P(Folds, RefineRounded, testing::Values(1, 3));

TEST(RefineMeasured, KeepsAGivenRAndFitsTheRest) {
  const Bank truth = test::true_scalar(1.0);
  const Recording recording = test::simulated_recording(truth, 4, 400, 13);
  const RefineOptions options{.restarts = 0, .folds = 1, .measurement_noise = false};
  Bank start = truth;
  for (Mode& mode : start.modes) mode.Q *= 2.0;
  const Bank bank = refine_bank(recording, test::windows_of(recording, 25, 1), {start}, options, {}).bank;
  EXPECT_EQ(bank.R(0, 0), truth.R(0, 0));
  EXPECT_EQ(bank.R_standard_error.size(), 0);
  for (const double z : test::z_values(bank, truth)) EXPECT_LT(std::abs(z), 3.0);
}

// One mode with a = -0.2, whose likelihood is exact.

constexpr double Q_true = 0.04;

Bank one_mode(double Q, double R) {
  return test::true_bank({1, 1, false}, Eigen::Vector2d(-0.2, 1.0), {Eigen::MatrixXd{{Q}}},
                         Eigen::VectorXd::Constant(1, R), 1.0);
}

Recording one_mode_with(double R) { return test::simulated_recording(one_mode(Q_true, R), 12, 800, 23); }

/// Searches R in these runs, from a bank.
class SearchOfR {
 public:
  SearchOfR(const Recording& runs, const Bank& bank, Index folds = 1) : recording(runs), start(bank) {
    options.folds = folds;
  }
  MeasurementNoise found() const { return find_measurement_noise(in, in.all, in.prior(exact, in.all), start); }
  /// The fit of exact states, chosen by left-out runs.
  Fit given(CrossValidation& validation) const {
    validation.consider({exact});
    Fit fit = validation.chosen();
    fit.bank = start;
    fit.prior = in.prior(exact, in.all);
    return fit;
  }

  const Recording& recording;
  Bank start;
  WindowFits fits = test::windows_of(recording, 25, 1);
  RefineOptions options;
  FilterOptions filter;
  BankCandidate exact{"", switching_model(start), 4.0};
  RefineInput in{
      fits, options, filter, {recording, start, gather_training_transitions(recording, start.structure), fits.global}};
};

/// R must be found for every ratio of R to Q, and none where the data show none.
TEST(FindMeasurementNoise, SplitsQAndR) {
  EXPECT_FALSE(SearchOfR(one_mode_with(0.0), one_mode(Q_true, 1e-9)).found().bank);
  for (const double R : {0.005, 0.02, 0.2}) {
    const std::optional<Bank> bank = SearchOfR(one_mode_with(R), one_mode(Q_true + 2.0 * R, 1e-9)).found().bank;
    ASSERT_TRUE(bank) << R;
    EXPECT_NEAR(bank->R(0, 0), R, 0.2 * R + 0.003) << R;
    EXPECT_NEAR(bank->modes[0].Q(0, 0), Q_true, 0.2 * Q_true) << R;
  }
}

TEST(FindMeasurementNoise, StartsThatFailAreCounted) {
  const Recording recording = one_mode_with(0.02);
  SearchOfR search(recording, one_mode(Q_true + 0.04, 1e-9));
  EXPECT_EQ(search.found().failed_starts, 0);
  search.start.modes[0].Q *= std::numeric_limits<double>::infinity();
  EXPECT_EQ(search.found().failed_starts, 2);
  EXPECT_FALSE(search.found().bank);
}

/// Regression test: with the theta of exact states, R = 0 was most likely, with a loss of 0.12 nats.
TEST(FindMeasurementNoise, FindsRThatThetaHides) {
  const Bank truth = one_mode(0.01, 0.01);
  const Recording recording = test::simulated_recording(truth, 4, 800, 5);
  const TrainingTransitions transitions = gather_training_transitions(recording, truth.structure);
  const Eigen::VectorXd theta = truth.theta(0) - Eigen::Vector2d(0.4, 0.0);
  const Eigen::VectorXd residual = transitions.data.increments - transitions.data.regressors * theta;
  Bank drawn = one_mode(residual.squaredNorm() / static_cast<double>(residual.size()), 1e-9);
  drawn.modes[0].model = unpack(truth.structure, theta);
  const std::optional<Bank> bank = SearchOfR(recording, drawn).found().bank;
  ASSERT_TRUE(bank);
  EXPECT_NEAR(bank->R(0, 0), truth.R(0, 0), 0.2 * truth.R(0, 0));
  EXPECT_NEAR(bank->theta(0)(0), truth.theta(0)(0), 0.05);
}

/// If the splits find no R, scores of left-out runs cannot test the R of all training runs.
TEST(MostlyHave, NeedsHalfOfTheSplitsToHaveAnROfItsSize) {
  const auto share = [](double R) { return one_mode(Q_true, R); };
  const Eigen::MatrixXd R = Eigen::MatrixXd::Constant(1, 1, 1e-4);
  EXPECT_TRUE(mostly_have({share(1e-4), share(2e-5), share(1e-6), share(0.0)}, R));
  EXPECT_FALSE(mostly_have({share(1e-4), share(1e-6), share(1e-6), share(0.0)}, R));
}

/// No part of a fit, including R, may use the runs that are scored with it. Here the last run has twenty times
/// the measurement noise.
TEST(RefineMeasured, ScoresAreOfFitsThatLeaveTheRunOut) {
  Recording recording = one_mode_with(0.02);
  recording.runs.push_back(one_mode_with(0.4).runs.front());
  recording.runs.back().run = "worse";
  const SearchOfR search(recording, one_mode(0.1, 1e-9), 4);
  CrossValidation validation(search.in);
  const Fit given = search.given(validation);
  MeasurementStage stage;
  EXPECT_TRUE(fit_with_measurement_noise(search.in, validation, given, stage).R_estimated);
  Eigen::Vector4d R;
  double expected = 0.0;
  for (std::size_t s = 0; s < 4; ++s) {
    const LearningRuns& runs = validation.learning()[s];
    const SwitchingPrior prior = search.in.prior(given.candidate, runs);
    const Bank bank = find_measurement_noise(search.in, runs, prior, given.of_splits[s]).bank.value();
    R(static_cast<Index>(s)) = bank.R(0, 0);
    for (const Trajectory& run : validation.splits()[s].left_out.runs) expected += log_likelihood(bank, run, {});
  }
  EXPECT_LT(R.minCoeff(), 0.5 * R.maxCoeff());
  EXPECT_NEAR(stage.score, expected / validation.samples().sum(), 1e-9);
}

TEST(RefineMeasured, NothingIsTakenWhereScoresAreNotNumbers) {
  const Recording recording = one_mode_with(0.02);
  const SearchOfR search(recording, one_mode(Q_true + 0.04, 1e-9), 3);
  CrossValidation validation(search.in);
  Fit given = search.given(validation);
  for (Bank& bank : given.of_splits) bank.modes[0].Q.setConstant(std::nan(""));
  MeasurementStage stage;
  EXPECT_FALSE(fit_with_measurement_noise(search.in, validation, given, stage).R_estimated);
}

}  // namespace
}  // namespace modebank
