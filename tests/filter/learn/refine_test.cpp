// Refinement: recovery on simulated truth, choice by cross-validation, screening, and noise that follows the run.
#include "filter/learn/refine/refine.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <Eigen/Eigenvalues>
#include <boost/random/normal_distribution.hpp>
#include <cmath>
#include <random>

#include "filter/learn/from_mixture/bank_frame.hpp"
#include "filter/learn/refine/averaging.hpp"
#include "filter/learn/refine/folds.hpp"
#include "filter/learn/switching/mode_screening.hpp"
#include "tests/filter/learn/learn_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using test::near;

struct Truth {
  Eigen::MatrixXd theta{{-0.2, -0.2, -0.6}, {0.3, 1.0, 0.6}};  // a and b of three modes, one per column
  Eigen::Vector3d Q{0.0025, 0.01, 0.04};
  Eigen::Matrix3d T{{0.96, 0.03, 0.01}, {0.02, 0.96, 0.02}, {0.02, 0.02, 0.96}};
};

/// x[k+1] = x + a x + b u + w in switching modes, measured exactly; `rough` scales the standard deviation of w.
void simulate(const Truth& truth, Index runs, Index samples, double rough, Role role, std::mt19937_64& generator,
              Recording& recording) {
  boost::random::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (Index i = 0; i < runs; ++i) {
    Eigen::MatrixXd x = Eigen::MatrixXd::Zero(1, samples), u(1, samples);
    Index mode = i % 3;
    for (Index k = 0; k < samples; ++k) {
      u(k) = normal(generator);
      double draw = uniform(generator);
      Index next = 0;
      while (next < 2 && (draw -= truth.T(mode, next)) > 0.0) ++next;
      mode = next;
      if (k + 1 < samples)
        x(k + 1) = x(k) + truth.theta(0, mode) * x(k) + truth.theta(1, mode) * u(k) +
                   rough * std::sqrt(truth.Q(mode)) * normal(generator);
    }
    test::add_run(recording, x, u, role);
  }
}

/// A bank of modes near the truth's.
Bank start_bank(const Recording& recording, const Eigen::MatrixXd& theta) {
  const LinearStructure structure = test::structure_of(recording);
  Bank bank = bank_frame(recording, structure, Eigen::MatrixXd::Zero(1, 1));
  for (Index j = 0; j < theta.cols(); ++j)
    bank.modes.push_back(make_mode(structure, theta.col(j), Eigen::MatrixXd::Constant(1, 1, 0.02), {}, {}, 1.0));
  set_mode_sequence(bank, TransitionMatrix::sticky(theta.cols(), 0.9));
  return bank;
}

FilterOptions adaptive_imm() {
  FilterOptions options;
  options.noise = FilterNoise::adaptive;
  return options;
}

RefineOptions quick() {
  RefineOptions options;
  options.restarts = 0;
  options.folds = 1;
  options.max_iterations = 100;
  options.tolerance = 1e-8;
  return options;
}

class Refine : public testing::Test {
 protected:
  Truth truth;
  std::mt19937_64 generator{17};
  Recording recording = test::empty_recording(1, 1);
  const Recording& learn_from(Index runs, Index samples) {
    simulate(truth, runs, samples, 1.0, Role::train, generator, recording);
    return recording;
  }
};

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
    return refine_bank(data, test::windows_of(data, 25, 1), {start_bank(data, truth.theta)}, options, adaptive_imm());
  };
  const Refinement alone = refine(recording);
  const tbb::global_control single(tbb::global_control::max_allowed_parallelism, 1);
  const Refinement other = refine(with_test);
  ASSERT_EQ(alone.bank.mode_count(), other.bank.mode_count());
  for (Index j = 0; j < alone.bank.mode_count(); ++j) EXPECT_TRUE(near(alone.bank.theta(j), other.bank.theta(j), 0.0));
  EXPECT_TRUE(near(alone.bank.transition.matrix(), other.bank.transition.matrix(), 0.0));
  EXPECT_EQ(alone.bank.noise_adaptation.forgetting, other.bank.noise_adaptation.forgetting);
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

/// The rival that knows one motion: what its modes differ in is noise.
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

/// The same as without folds: nothing tells whether a stronger prior on Q would pay.
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

TEST_F(Refine, AdaptiveNoiseIsWorthItWhereARunIsQuieter) {
  Recording quiet = test::empty_recording(1, 1);
  simulate(truth, 1, 400, 0.4, Role::test, generator, quiet);
  const Bank bank = [&] {
    Bank known = start_bank(quiet, truth.theta);
    for (Index j = 0; j < 3; ++j) known.modes[static_cast<std::size_t>(j)].Q(0, 0) = truth.Q(j);
    known.transition = TransitionMatrix(truth.T);
    return known;
  }();
  ;
  const double gain = log_likelihood(bank, quiet.runs[0], adaptive_imm()) - log_likelihood(bank, quiet.runs[0], {});
  EXPECT_GT(gain / 399.0, 0.2);
}

TEST_F(Refine, FitsAreAveragedWhereRunsLeftOutGainByIt) {
  learn_from(6, 60);
  Eigen::MatrixXd many(2, 6);  // far more modes than so few samples tell apart: every start ends elsewhere
  many << truth.theta, 1.5 * truth.theta;
  RefineOptions options;
  options.restarts = 5;
  options.members = 4;
  options.screen = false;
  const WindowFits fits = test::windows_of(recording, 25, 1);
  const Refinement refined = refine_bank(recording, fits, {start_bank(recording, many)}, options, adaptive_imm());
  ASSERT_GT(refined.averaging.members, 1);
  EXPECT_LE(refined.averaging.members, 4);
  EXPECT_GT(refined.averaging.score, refined.averaging.score_before);
  EXPECT_EQ(refined.bank.mode_count(), 6 * refined.averaging.members);
  Index selected = 0;
  for (const RefineCandidate& c : refined.candidates) selected += c.selected ? 1 : 0;
  EXPECT_EQ(selected, refined.averaging.members);
  double weights = 0.0;
  for (const Mode& mode : refined.bank.modes) {
    weights += mode.weight;
    EXPECT_TRUE(mode.standard_error.allFinite());
  }
  EXPECT_NEAR(weights, 1.0, 1e-12);
}

TEST_F(Refine, OneFitIsKeptWhereAllStartsEndThere) {
  learn_from(4, 400);
  RefineOptions options;
  options.restarts = 0;
  options.members = 4;
  const WindowFits fits = test::windows_of(recording, 25, 1);
  Eigen::MatrixXd elsewhere = truth.theta;
  elsewhere.row(1) += Eigen::RowVector3d(0.05, -0.05, 0.05);
  const Bank first = start_bank(recording, truth.theta), second = start_bank(recording, elsewhere);
  const Bank smaller = start_bank(recording, truth.theta.leftCols(2));
  const Refinement refined = refine_bank(recording, fits, {first, second, smaller}, options, {});
  EXPECT_EQ(refined.averaging.members, 1);
  EXPECT_EQ(refined.bank.mode_count(), 3);
}

class UnitedBank : public Refine {
 protected:
  Bank bank_of(double scale) {
    Bank bank = start_bank(recording, scale * truth.theta);
    for (Index j = 0; j < 3; ++j) bank.modes[static_cast<std::size_t>(j)].Q(0, 0) = truth.Q(j);
    bank.transition = TransitionMatrix(truth.T);
    return bank;
  }
};

TEST_F(UnitedBank, WithoutSwitchingIsBayesianModelAveraging) {
  learn_from(1, 80);
  const Bank first = bank_of(1.0), second = bank_of(0.8);
  const Trajectory& run = recording.runs.front();
  const double a = log_likelihood(first, run, {}), b = log_likelihood(second, run, {});
  EXPECT_NEAR(log_likelihood(unite({first, second}, 0.0), run, {}), b + std::log(0.5 * (1.0 + std::exp(a - b))), 1e-9);
  EXPECT_NEAR(log_likelihood(unite({first, first, first}, 0.0), run, {}), a, 1e-9);
}

TEST_F(UnitedBank, SwitchingKeepsTheLongRunShares) {
  learn_from(1, 20);
  const Bank united = unite({bank_of(1.0), bank_of(0.8)}, 0.05);
  ASSERT_EQ(united.mode_count(), 6);
  const Eigen::MatrixXd& T = united.transition.matrix();
  EXPECT_TRUE(near(T.rowwise().sum(), Eigen::VectorXd::Ones(6), 1e-15));
  Eigen::RowVectorXd share = Eigen::RowVectorXd::Constant(3, 1.0 / 3.0);
  for (int i = 0; i < 5000; ++i) share = (share * truth.T).eval();
  Eigen::RowVectorXd both(6);
  both << 0.5 * share, 0.5 * share;
  EXPECT_TRUE(near(Eigen::MatrixXd(both * T), Eigen::MatrixXd(both), 1e-9));
  EXPECT_NEAR(T.row(0).tail(3).sum(), 0.025, 1e-12);
  EXPECT_THROW(unite({}, 0.1), std::invalid_argument);
}

TEST(RefineScreening, SecondMomentsGrowAsTheJumpSystemSays) {
  const LinearStructure scalar{1, 1, false};
  SwitchingRegression model{Eigen::MatrixXd{{-0.5, 0.2}, {0.0, 0.0}},
                            {Eigen::MatrixXd::Ones(1, 1), Eigen::MatrixXd::Ones(1, 1)},
                            Eigen::MatrixXd{{0.7, 0.3}, {0.7, 0.3}},
                            Eigen::Vector2d(0.5, 0.5)};
  EXPECT_NEAR(mean_square_growth(scalar, model), 0.7 * 0.25 + 0.3 * 1.44, 1e-6);  // independent draws: sum p_j f_j^2
  model.transition = Eigen::Matrix2d{{0.5, 0.5}, {0.01, 0.99}};
  EXPECT_GT(mean_square_growth(scalar, model), 1.0);
  model.transition = Eigen::Matrix2d{{0.9, 0.1}, {0.8, 0.2}};
  const Eigen::Matrix2d moments = (model.transition.transpose() * Eigen::Vector2d(0.25, 1.44).asDiagonal());
  EXPECT_NEAR(mean_square_growth(scalar, model), moments.eigenvalues().cwiseAbs().maxCoeff(), 1e-6);
}

TEST(NoiseScale, IsTheDiscountedMeanOfStandardisedSquares) {
  Recording recording = test::empty_recording(1, 1);
  Eigen::MatrixXd x(1, 8);
  x << 0.0, 0.3, -0.2, 0.5, 0.6, 0.1, -0.3, 0.2;
  test::add_run(recording, x, Eigen::MatrixXd::Zero(1, 8));
  const LinearStructure structure = test::structure_of(recording);
  Bank bank = bank_frame(recording, structure, Eigen::MatrixXd::Zero(1, 1));
  const double Q = 0.09, f = 0.9, n0 = 3.0;
  bank.modes.push_back(
      make_mode(structure, Eigen::Vector2d(-0.5, 0.0), Eigen::MatrixXd::Constant(1, 1, Q), {}, {}, 1.0));
  set_mode_sequence(bank, TransitionMatrix());
  bank.noise_adaptation = {f, n0};
  const RunEvaluation e = evaluate_run(bank, recording.runs[0], adaptive_imm());
  double weight = n0, squares = n0;
  for (Index k = 1; k < 8; ++k) {
    EXPECT_NEAR(e.innovation_covariance(0, k), squares / weight * Q, 1e-14);
    const double r = x(k) - 0.5 * x(k - 1);
    weight = f * weight + (1.0 - f) * n0 + 1.0;
    squares = f * squares + (1.0 - f) * n0 + r * r / Q;
  }
}

TEST(NoiseScale, StaysWhereMeasurementNoiseExplainsEverything) {
  Recording recording = test::empty_recording(1, 1);
  test::add_run(recording, Eigen::MatrixXd::Random(1, 50), Eigen::MatrixXd::Zero(1, 50));
  const LinearStructure structure = test::structure_of(recording);
  Bank bank = bank_frame(recording, structure, Eigen::MatrixXd::Ones(1, 1));
  bank.modes.push_back(
      make_mode(structure, Eigen::Vector2d(0.0, 0.0), Eigen::MatrixXd::Constant(1, 1, 1e-12), {}, {}, 1.0));
  set_mode_sequence(bank, TransitionMatrix());
  const RunEvaluation plain = evaluate_run(bank, recording.runs[0], {});
  const RunEvaluation e = evaluate_run(bank, recording.runs[0], adaptive_imm());
  EXPECT_TRUE(near(e.innovation_covariance.rightCols(49), plain.innovation_covariance.rightCols(49), 1e-9));
}

TEST(ValidationSplits, LeaveEveryTrainingRunOutOnce) {
  Recording recording = test::empty_recording(1, 1);
  for (const Index samples : {30, 200, 60, 90, 40, 100, 20})
    test::add_run(recording, Eigen::MatrixXd::Zero(1, samples), Eigen::MatrixXd::Zero(1, samples));
  recording.runs.back().role = Role::test;
  const std::vector<ValidationSplit> splits = validation_splits(recording, 4);
  ASSERT_EQ(splits.size(), 4u);
  std::vector<std::string> left_out;
  for (const ValidationSplit& split : splits) {
    EXPECT_EQ(split.training.runs.size() + split.left_out.runs.size(), 6u);
    for (const Trajectory& run : split.left_out.runs) left_out.push_back(run.run);
  }
  EXPECT_THAT(left_out, testing::UnorderedElementsAre("run0", "run1", "run2", "run3", "run4", "run5"));
}

TEST(ValidationSplits, CutASingleRunIntoStretches) {
  Recording recording = test::empty_recording(1, 1);
  test::add_run(recording, Eigen::RowVectorXd::LinSpaced(103, 0.0, 102.0), Eigen::MatrixXd::Zero(1, 103));
  const std::vector<ValidationSplit> splits = validation_splits(recording, 4);
  ASSERT_EQ(splits.size(), 4u);
  Index samples = 0;
  double sum = 0.0;
  for (const ValidationSplit& split : splits)
    for (const Trajectory& run : split.left_out.runs) {
      samples += run.samples();
      sum += run.state.sum();
    }
  EXPECT_EQ(samples, 103);
  EXPECT_EQ(sum, 102.0 * 103.0 / 2.0);
  EXPECT_TRUE(validation_splits(recording, 1).empty());
}

}  // namespace
}  // namespace modebank
