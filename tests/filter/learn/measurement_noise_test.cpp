// R by the filter's likelihood, and refinement with measurement noise: theta, Q, R and T together.
#include <gtest/gtest.h>

#include <algorithm>

#include "filter/judge/evaluate.hpp"
#include "filter/learn/likelihood/maximum_likelihood.hpp"
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
  EXPECT_LT(found.bank.transition_standard_error.maxCoeff(), 0.03);
  for (const Mode& mode : found.bank.modes) {
    EXPECT_LT(mode.standard_error.maxCoeff(), 0.2);  // inputs have a standard deviation of 0.29
    EXPECT_LT(mode.Q_standard_error(0, 0), 0.3 * mode.Q(0, 0));
  }
}

/// Rounding alone must give no R beside its own.
TEST_P(RefineRounded, TakesRoundingForNoNoise) {
  const double quantum = 0.2;
  truth.R.setZero();
  const Refinement found = refined(quantum);
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

/// R must be found for every ratio of R to Q, and none where the data show none.
TEST(RefineMeasured, SplitsQAndR) {
  for (const double R : {0.0, 0.005, 0.02, 0.2}) {
    const Recording recording = one_mode_with(R);
    const RefineOptions options{.restarts = 0, .folds = 1};
    const Bank bank =
        refine_bank(recording, test::windows_of(recording, 25, 1), {one_mode(Q_true, R)}, options, {}).bank;
    EXPECT_NEAR(bank.R(0, 0), R, 0.2 * R + 0.003) << R;
    EXPECT_NEAR(bank.modes[0].Q(0, 0), Q_true, 0.2 * Q_true) << R;
    EXPECT_NEAR(bank.theta(0)(0), -0.2, 0.05) << "exact states would hide R in theta";
  }
}

/// Inputs of a refinement with unknown states.
class Measured {
 public:
  Measured(const Recording& runs, const Bank& bank, Index folds) : recording(runs), start(bank) {
    options.folds = folds;
    in.single.R = Eigen::VectorXd::Constant(1, 0.02);
    in.unknown_states = true;
  }

  const Recording& recording;
  Bank start;
  WindowFits fits = test::windows_of(recording, 25, 1);
  RefineOptions options;
  FilterOptions filter;
  BankCandidate exact{"", switching_model(start)};
  RefineInput in{
      fits, options, filter, {recording, gather_training_transitions(recording, start.structure), fits.global}, start};
};

/// At R = 0 candidates are scored by the switching regression, whose likelihood of complete transitions is the
/// filter's. If a split leaves out none, the filter scores.
TEST(CrossValidation, ScoresAreTheFilters) {
  const Bank truth = test::true_three();
  Recording recording = test::simulated_recording(truth, 4, 150, 3);
  recording.runs.push_back(test::simulated_recording(truth, 1, 260, 4).runs.front());
  for (const Index folds : {3, 5}) {
    for (Index k = 0; folds == 5 && k < 150; k += 2) recording.runs[0].state(k) = std::nan("");
    Measured search(recording, truth, folds);
    search.in.unknown_states = false;
    CrossValidation validation(search.in);
    validation.consider({search.exact});
    const Fit& chosen = validation.chosen();
    EXPECT_EQ(validation.samples().sum(), 4.0 * 149.0 + 259.0);
    const LeftOutScores expected = validation.scores(chosen.of_splits);
    EXPECT_TRUE(test::near(chosen.scores.log_likelihood, expected.log_likelihood, folds == 3 ? 1e-5 : 0.0)) << folds;
  }
}

/// No part of a fit, including R, may use the runs that are scored with it. Here the last run has twenty times
/// the measurement noise.
TEST(RefineMeasured, ScoresAreOfFitsThatLeaveTheRunOut) {
  Recording recording = one_mode_with(0.02);
  recording.runs.push_back(one_mode_with(0.4).runs.front());
  recording.runs.back().run = "worse";
  const Measured search(recording, one_mode(0.1, 1e-9), 4);
  CrossValidation validation(search.in);
  validation.consider("one", maximise_measured(search.in, search.in.all, with_R_out_of_Q(search.in, search.start), 20));
  Eigen::Vector4d R;
  double expected = 0.0;
  Bank start = validation.chosen().learned.bank;
  start.R.setConstant(0.02);
  for (std::size_t s = 0; s < 4; ++s) {
    const Bank bank = maximise_measured(search.in, validation.learning()[s], start, 20).bank;
    R(static_cast<Index>(s)) = bank.R(0, 0);
    for (const Trajectory& run : validation.splits()[s].left_out.runs) expected += log_likelihood(bank, run, {});
  }
  EXPECT_LT(R.minCoeff(), 0.5 * R.maxCoeff());
  EXPECT_NEAR(validation.chosen().scores.log_likelihood.sum(), expected, 1e-6);
}

}  // namespace
}  // namespace modebank
