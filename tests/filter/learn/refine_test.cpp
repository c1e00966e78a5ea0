// Refinement: recovery of simulated parameters, choice by cross-validation, screening.
#include "filter/learn/refine/refine.hpp"

#include <gmock/gmock.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <limits>

#include "tests/filter/learn/refine_recovery.hpp"

namespace modebank {
namespace {

/// Runs of a system with known modes for learning.
class Refine : public testing::Test {
 protected:
  Bank truth = test::true_three();
  RefineOptions options{.tolerance = 1e-8, .restarts = 0, .folds = 1};

  /// From modes near the true ones, `off` by this coefficient of the input.
  Refinement refined(const Recording& from, const Eigen::Vector3d& off = {0.0, 0.0, 0.0}) const {
    Bank start = truth;
    for (std::size_t j = 0; j < 3; ++j) {
      start.modes[j].model.B(0, 0) += off(static_cast<Index>(j));
      start.modes[j].Q(0, 0) = 0.02;
    }
    set_mode_sequence(start, TransitionMatrix::sticky(3, 0.9));
    return refine_bank(from, test::windows_of(from, 25, 1), {start}, options, {});
  }
};

TEST_F(Refine, RecoversThetaNoiseAndTransitionsWithinThreeStandardErrors) {
  const Bank bank = refined(test::simulated_recording(truth, 6, 700, 17), {0.3, -0.3, 0.2}).bank;
  ASSERT_EQ(bank.mode_count(), 3);
  for (const double z : test::z_values(bank, truth)) EXPECT_LT(std::abs(z), 3.0);
  for (const Mode& mode : bank.modes) EXPECT_LT(mode.Q_standard_error(0, 0), 0.15 * mode.Q(0, 0));
}

TEST_F(Refine, ModesThatTheDataDoNotTellApartAreScreenedAsDuplicates) {
  truth.modes[2] = truth.modes[1];
  const Refinement found = refined(test::simulated_recording(truth, 5, 300, 17));
  EXPECT_EQ(found.bank.mode_count(), 2);
  ASSERT_EQ(found.bank.screened.size(), 1u);
  EXPECT_THAT(found.bank.screened[0].reason, testing::HasSubstr("duplicate of mode"));
  EXPECT_EQ(found.start.mode_count(), 3);
}

TEST_F(Refine, ChoiceRestsOnTrainingRunsAloneForAnyNumberOfThreads) {
  const Recording recording = test::simulated_recording(truth, 3, 120, 17);
  Recording with_test = recording;
  with_test.runs.push_back(recording.runs.front());
  with_test.runs.back().role = Role::test;
  with_test.runs.back().state *= 5.0;
  options = {.max_iterations = 12, .restarts = 1};
  const Refinement alone = refined(recording);
  const tbb::global_control single(tbb::global_control::max_allowed_parallelism, 1);
  const Refinement other = refined(with_test);
  ASSERT_EQ(alone.bank.mode_count(), other.bank.mode_count());
  for (Index j = 0; j < alone.bank.mode_count(); ++j) EXPECT_EQ(alone.bank.theta(j), other.bank.theta(j));
  EXPECT_EQ(alone.bank.transition.matrix(), other.bank.transition.matrix());
  const double best = std::ranges::max(alone.candidates, {}, &RefineCandidate::score).score;
  for (const RefineCandidate& row : alone.candidates) EXPECT_NEAR(row.loss, best - row.score, 1e-12);
  EXPECT_EQ(std::ranges::count_if(alone.candidates, &RefineCandidate::selected), 1);
}

TEST_F(Refine, IterationsGoOnWhereLeftOutRunsGain) {
  const Recording recording = test::simulated_recording(truth, 3, 120, 17);
  options.folds = 3;
  double before = -std::numeric_limits<double>::infinity();
  for (const Index limit : {0, 10, 100}) {
    options.max_iterations = limit;
    const RefineCandidate row = refined(recording, {0.3, -0.3, 0.2}).candidates.front();
    EXPECT_GT(row.score, before) << limit;
    EXPECT_LE(row.iterations, limit);
    before = row.score;
  }
}

/// The competitor with one motion.
TEST_F(Refine, OneThetaIsThatOfAllModes) {
  for (Mode& mode : truth.modes) mode.model = truth.modes[0].model;
  truth.motion.assign(3, 0);
  const Bank bank = refined(test::simulated_recording(truth, 4, 400, 17), {0.3, -0.3, 0.2}).bank;
  ASSERT_GT(bank.mode_count(), 1);
  for (Index j = 0; j < bank.mode_count(); ++j) {
    const Mode& mode = bank.modes[j];
    EXPECT_EQ(bank.theta(j), bank.theta(0));
    EXPECT_EQ(mode.standard_error, bank.modes[0].standard_error);
    EXPECT_TRUE(((bank.theta(j) - truth.theta(0)).array().abs() < 3.0 * mode.standard_error.array()).all());
  }
}

TEST_F(Refine, MotionModelsAreRefused) {
  Bank bank;
  bank.motion_parameters.push_back({"slip", ""});
  EXPECT_THROW(refine_bank({}, {}, {bank}, options, {}), std::invalid_argument);
}

}  // namespace
}  // namespace modebank
