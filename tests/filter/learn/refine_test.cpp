// Refinement: recovery of simulated parameters, choice by cross-validation, screening.
#include "filter/learn/refine/refine.hpp"

#include <gmock/gmock.h>
#include <tbb/global_control.h>

#include "tests/filter/learn/refine_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using test::near;
using test::quick;
using test::simulate;
using test::start_bank;

using Refine = test::RefineTest;

TEST_F(Refine, RecoversThetaNoiseAndTransitionsWithinThreeStandardErrors) {
  learn_from(6, 700);
  const WindowFits fits = test::windows_of(recording, 25, 1);
  Eigen::MatrixXd theta = truth.theta;
  theta.row(1) += Eigen::RowVector3d(0.1, -0.1, 0.05);
  const Refinement refined = refine_bank(recording, fits, {start_bank(recording, theta)}, quick(), {});
  ASSERT_EQ(refined.bank.mode_count(), 3);
  for (Index j = 0; j < 3; ++j) {
    const Mode& mode = refined.bank.modes[static_cast<std::size_t>(j)];
    EXPECT_TRUE(((refined.bank.theta(j) - truth.theta.col(j)).array().abs() < 3.0 * mode.standard_error.array()).all());
    EXPECT_LT(std::abs(mode.Q(0, 0) - truth.Q(j)), 3.0 * mode.Q_standard_error(0, 0));
    EXPECT_LT(mode.Q_standard_error(0, 0), 0.15 * truth.Q(j));
  }
  const Eigen::MatrixXd error = refined.bank.transition.matrix() - truth.T;
  EXPECT_TRUE((error.array().abs() < 3.0 * refined.bank.transition_standard_error.array()).all());
  for (std::size_t i = 2; i < refined.objective.size(); ++i)
    EXPECT_GE(refined.objective[i], refined.objective[i - 1] - 1e-8);
}

TEST_F(Refine, ModesThatTheDataDoNotTellApartAreScreenedAsDuplicates) {
  truth.theta.col(2) = truth.theta.col(1);
  truth.Q(2) = truth.Q(1);
  learn_from(5, 300);
  const WindowFits fits = test::windows_of(recording, 25, 1);
  const Refinement refined = refine_bank(recording, fits, {start_bank(recording, truth.theta)}, quick(), {});
  EXPECT_EQ(refined.bank.mode_count(), 2);
  ASSERT_EQ(refined.bank.screened.size(), 1u);
  EXPECT_THAT(refined.bank.screened[0].reason, testing::HasSubstr("duplicate of mode"));
  EXPECT_EQ(refined.start.mode_count(), 3);
}

TEST_F(Refine, ChoiceRestsOnTrainingRunsAloneForAnyNumberOfThreads) {
  learn_from(3, 120);
  Recording with_test = recording;
  simulate(truth, 1, 100, 5.0, Role::test, generator, with_test);
  RefineOptions options;
  options.max_iterations = 12;
  options.restarts = 1;
  const auto refine = [&](const Recording& data) {
    return refine_bank(data, test::windows_of(data, 25, 1), {start_bank(data, truth.theta)}, options, {});
  };
  const Refinement alone = refine(recording);
  const tbb::global_control single(tbb::global_control::max_allowed_parallelism, 1);
  const Refinement other = refine(with_test);
  ASSERT_EQ(alone.bank.mode_count(), other.bank.mode_count());
  for (Index j = 0; j < alone.bank.mode_count(); ++j) EXPECT_TRUE(near(alone.bank.theta(j), other.bank.theta(j), 0.0));
  EXPECT_TRUE(near(alone.bank.transition.matrix(), other.bank.transition.matrix(), 0.0));
  Index selected = 0;
  double best = -1e300;
  for (const RefineCandidate& c : alone.candidates) best = std::max(best, c.score);
  for (const RefineCandidate& c : alone.candidates)
    if (c.selected) {
      ++selected;
      EXPECT_EQ(c.score, best);
    }
  EXPECT_EQ(selected, 1);
}

/// The competitor with one motion: its modes differ only in noise.
TEST_F(Refine, OneThetaIsThatOfAllModes) {
  truth.theta.colwise() = truth.theta.col(0).eval();
  learn_from(4, 400);
  RefineOptions options = quick();
  options.one_theta = true;
  Eigen::MatrixXd theta = truth.theta;
  theta.row(1) += Eigen::RowVector3d(0.1, -0.1, 0.05);
  const Bank bank =
      refine_bank(recording, test::windows_of(recording, 25, 1), {start_bank(recording, theta)}, options, {}).bank;
  ASSERT_GT(bank.mode_count(), 1);
  for (Index j = 0; j < bank.mode_count(); ++j) {
    const Mode& mode = bank.modes[static_cast<std::size_t>(j)];
    EXPECT_EQ(bank.theta(j), bank.theta(0));
    EXPECT_EQ(mode.standard_error, bank.modes[0].standard_error);
    EXPECT_TRUE(((bank.theta(j) - truth.theta.col(0)).array().abs() < 3.0 * mode.standard_error.array()).all());
  }
}

/// Without folds no score can decide whether a stronger prior on Q gains.
TEST_F(Refine, WithoutAnythingToLeaveOutThePriorIsWorthOneTransition) {
  learn_from(1, 30);
  RefineOptions options = quick();
  const auto refine = [&] {
    return refine_bank(recording, test::windows_of(recording, 25, 1), {start_bank(recording, truth.theta)}, options,
                       {});
  };
  const Refinement without_folds = refine();
  options.folds = 6;
  const Refinement refined = refine();
  ASSERT_EQ(refined.candidates.size(), 1u);
  EXPECT_EQ(refined.candidates[0].noise_transitions, 1.0);
  EXPECT_EQ(refined.bank.theta(0), without_folds.bank.theta(0));
}

TEST_F(Refine, MotionModelsAreRefused) {
  learn_from(2, 50);
  Bank bank = start_bank(recording, truth.theta);
  bank.motion_parameters.push_back({"slip", ""});
  EXPECT_THROW(refine_bank(recording, test::windows_of(recording, 25, 1), {bank}, quick(), {}), std::invalid_argument);
}

}  // namespace
}  // namespace modebank
