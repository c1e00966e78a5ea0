// Laws every filter bank must obey, whatever its numbers.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <stdexcept>

#include "filter/bank_filter.hpp"
#include "filter/evaluate.hpp"
#include "filter/imm.hpp"
#include "ident/error.hpp"
#include "tests/filter/filter_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using test::example_bank;
using test::near;
using test::simulate_bank;
using test::single_mode;

/// Two double-precision routes to one number of order one.
constexpr double rounding = 1e-12;
constexpr FilterOptions imm{}, mmae{FilterVariant::mmae}, kf{FilterVariant::kf};

void expect_same_estimates(const RunEvaluation& a, const RunEvaluation& b) {
  EXPECT_TRUE(near(a.prediction, b.prediction, rounding));
  EXPECT_TRUE(near(a.innovation_covariance, b.innovation_covariance, rounding));
  EXPECT_TRUE(near(a.state, b.state, rounding));
  EXPECT_TRUE(near(a.covariance, b.covariance, rounding));
  EXPECT_TRUE(near(a.log_density, b.log_density, rounding * 10));  // log densities reach about ten
  EXPECT_TRUE(near(a.pit, b.pit, rounding));
}

TEST(MixingWeights, PredictedProbabilitiesFollowTheRowsOfTheTransitionMatrix) {
  // 0.7 * 0.95 + 0.3 * 0.10 = 0.695; with rows and columns swapped it would be 0.68.
  const TransitionMatrix T((Eigen::MatrixXd(2, 2) << 0.95, 0.05, 0.10, 0.90).finished());
  Eigen::VectorXd c(2);
  MixingWeights weights{Eigen::MatrixXd(2, 2)};
  mixing_weights(T, Eigen::Vector2d(0.7, 0.3), c, weights);
  EXPECT_TRUE(near(c, Eigen::Vector2d(0.695, 0.305), rounding));
  EXPECT_TRUE(near(weights.matrix.colwise().sum(), Eigen::RowVector2d::Ones(), rounding));
  EXPECT_NEAR(weights.matrix(1, 0), 0.3 * 0.10 / 0.695, rounding);
}

TEST(Imm, EqualLikelihoodsLeaveThePredictedProbabilities) {
  Bank bank = example_bank(1, 2, 2);
  bank.modes[1] = bank.modes[0];
  bank.transition = TransitionMatrix((Eigen::MatrixXd(2, 2) << 0.95, 0.05, 0.10, 0.90).finished());
  bank.initial_probability << 0.7, 0.3;
  const RunEvaluation result = evaluate_run(bank, simulate_bank(bank, 2, 1), imm);
  EXPECT_TRUE(near(result.mode_probability_predicted.col(1), Eigen::Vector2d(0.695, 0.305), rounding));
  EXPECT_TRUE(near(result.mode_probability.col(1), Eigen::Vector2d(0.695, 0.305), rounding));
}

TEST(Imm, IdenticalModesAreOneFilter) {
  for (const Eigen::Index n : {1, 2, 4}) {
    Bank bank = example_bank(n, 2, 3);
    bank.modes[1] = bank.modes[2] = bank.modes[0];
    const Trajectory run = simulate_bank(bank, 60, 2);
    expect_same_estimates(evaluate_run(bank, run, imm), evaluate_run(bank, run, kf));
  }
}

TEST(Imm, OneModeIsTheKalmanFilter) {
  const Bank bank = single_mode(example_bank(2, 1, 2), 1);
  const Trajectory run = simulate_bank(bank, 60, 3);
  expect_same_estimates(evaluate_run(bank, run, imm), evaluate_run(bank, run, kf));
}

TEST(Kf, IsTheFirstModeOfALargerBank) {
  const Bank bank = example_bank(1, 2, 3);
  const Trajectory run = simulate_bank(bank, 60, 3);
  const RunEvaluation result = evaluate_run(bank, run, kf);
  expect_same_estimates(result, evaluate_run(single_mode(bank, 0), run, imm));
  EXPECT_TRUE(near(result.mode_probability.row(0), Eigen::RowVectorXd::Ones(60), 0.0));
  EXPECT_TRUE(near(result.mode_probability.bottomRows(2), Eigen::MatrixXd::Zero(2, 60), 0.0));
}

TEST(Imm, ProbabilitiesSumToOne) {
  const Bank bank = example_bank(2, 1, 4);
  const Trajectory run = simulate_bank(bank, 200, 4);
  for (const FilterVariant variant : {FilterVariant::imm, FilterVariant::mmae, FilterVariant::salvi2025}) {
    const RunEvaluation result = evaluate_run(bank, run, {variant});
    EXPECT_TRUE(near(result.mode_probability.colwise().sum(), Eigen::RowVectorXd::Ones(200), rounding));
    EXPECT_TRUE(near(result.mode_probability_predicted.colwise().sum(), Eigen::RowVectorXd::Ones(200), rounding));
    EXPECT_GE(result.mode_probability.minCoeff(), 0.5 * mode_probability_floor);
  }
}

TEST(Mmae, IsBayesRuleOverSeparateFilters) {
  Bank bank = example_bank(2, 1, 3);
  for (std::size_t j = 0; j < 3; ++j) bank.modes[j] = bank.modes[0];
  for (std::size_t j = 1; j < 3; ++j) bank.modes[j].Q *= 1.0 + 0.3 * static_cast<double>(j);
  const Trajectory run = simulate_bank(bank, 40, 5);
  Eigen::MatrixXd log_weight(3, 40);
  for (std::size_t j = 0; j < 3; ++j) {
    const RunEvaluation alone = evaluate_run(single_mode(bank, j), run, kf);
    double sum = std::log(bank.initial_probability(static_cast<Eigen::Index>(j)));
    for (Eigen::Index k = 0; k < 40; ++k)
      log_weight(static_cast<Eigen::Index>(j), k) = sum += k > 0 ? alone.log_density(k) : 0.0;
  }
  Eigen::MatrixXd expected(3, 40);
  Eigen::VectorXd evidence(40);
  for (Eigen::Index k = 0; k < 40; ++k) {
    const double largest = log_weight.col(k).maxCoeff();
    expected.col(k) = (log_weight.col(k).array() - largest).exp();
    evidence(k) = largest + std::log(expected.col(k).sum());
    expected.col(k) /= expected.col(k).sum();
  }
  ASSERT_GT(expected.minCoeff(), 1e-9) << "the floor of probabilities would interfere";

  const RunEvaluation result = evaluate_run(bank, run, mmae);
  EXPECT_TRUE(near(result.mode_probability, expected, rounding * 100));  // sums of 40 log densities of order ten
  EXPECT_NEAR(result.log_density.tail(39).sum(), evidence(39), rounding * 1000);

  bank.transition = TransitionMatrix(Eigen::MatrixXd::Identity(3, 3));
  expect_same_estimates(evaluate_run(bank, run, imm), result);
}

TEST(Kf, WithoutProcessNoiseIsBatchLeastSquares) {
  Bank bank = single_mode(example_bank(2, 1, 1, 0.01), 0);
  bank.modes[0].Q.setZero();
  const Trajectory run = simulate_bank(bank, 30, 6);
  // y_k = F^k x_0 + d_k + v_k: normal equations for x_0, then the estimate carried to the last sample.
  const LinearModel& model = bank.modes[0].model;
  const Eigen::Matrix2d F = model.full_form();
  Eigen::Matrix2d power = Eigen::Matrix2d::Identity(), information = Eigen::Matrix2d::Zero();
  Eigen::Vector2d offset = Eigen::Vector2d::Zero(), right = Eigen::Vector2d::Zero();
  for (Eigen::Index k = 0; k < 30; ++k) {
    if (k > 0) {
      power = F * power;
      offset = F * offset + model.B * run.input.col(k - 1) + model.c;
    }
    information += power.transpose() * bank.R.inverse() * power;
    right += power.transpose() * bank.R.inverse() * (run.state.col(k) - offset);
  }
  const Eigen::Vector2d x = power * information.inverse() * right + offset;
  const Eigen::Matrix2d P = power * information.inverse() * power.transpose();

  const RunEvaluation result = evaluate_run(bank, run, kf);
  EXPECT_TRUE(near(result.state.col(29), x, rounding));
  EXPECT_TRUE(near(result.covariance.col(29), P.reshaped(), rounding));
}

TEST(Start, IsTheFirstMeasurementWithItsCovariance) {
  const Bank bank = example_bank(3, 2, 2);
  const Trajectory run = simulate_bank(bank, 5, 7);
  const RunEvaluation result = evaluate_run(bank, run, imm);
  EXPECT_TRUE(near(result.state.col(0), run.state.col(0), rounding));
  EXPECT_TRUE(near(result.covariance.col(0), bank.R.reshaped(), rounding));
  EXPECT_TRUE(std::isnan(result.log_density(0)) && std::isnan(result.nis(0)) && std::isnan(result.pit(0, 0)));
}

TEST(Start, WaitsForTheFirstWholeMeasurement) {
  const Bank bank = example_bank(2, 1, 2);
  Trajectory run = simulate_bank(bank, 20, 8);
  Trajectory tail = run;
  tail.time_s = run.time_s.tail(17).eval();
  tail.state = run.state.rightCols(17).eval();
  tail.input = run.input.rightCols(17).eval();
  run.state.leftCols(2).setConstant(std::nan(""));
  run.state(1, 2) = std::nan("");
  const RunEvaluation late = evaluate_run(bank, run, imm), fresh = evaluate_run(bank, tail, imm);
  EXPECT_TRUE(near(late.state.rightCols(17), fresh.state, 0.0));
  EXPECT_TRUE(near(late.log_density.tail(17), fresh.log_density, 0.0));
  EXPECT_TRUE(late.state.leftCols(3).array().isNaN().all());
  EXPECT_TRUE(near(late.mode_probability.col(1), bank.initial_probability, 0.0));
  EXPECT_EQ(log_likelihood(bank, run, imm), log_likelihood(bank, tail, imm));
}

TEST(MissingMeasurement, IsAPredictionOnlyStep) {
  const Bank bank = example_bank(2, 1, 2);
  Trajectory run = simulate_bank(bank, 10, 9);
  run.state.col(6).setConstant(std::nan(""));
  const RunEvaluation result = evaluate_run(bank, run, imm);
  EXPECT_TRUE(near(result.state.col(6), result.prediction.col(6), rounding));
  EXPECT_TRUE(near(result.mode_probability.col(6), result.mode_probability_predicted.col(6), rounding));
  EXPECT_TRUE(near(result.covariance.col(6) + bank.R.reshaped(), result.innovation_covariance.col(6), rounding));
  EXPECT_TRUE(std::isnan(result.log_density(6)) && std::isnan(result.nis(6)));
  EXPECT_TRUE(result.innovation.col(6).array().isNaN().all() && result.pit.col(6).array().isNaN().all());
  EXPECT_TRUE(std::isfinite(result.log_density(7)));
}

/// The bank that measures only the signals `rows`.
Bank measuring(Bank bank, const std::vector<Eigen::Index>& rows) {
  bank.C = bank.C(rows, Eigen::all).eval();
  bank.R = bank.R(rows, rows).eval();
  return bank;
}

TEST(MissingMeasurement, OfSomeSignalsLeavesTheOthers) {
  Bank bank = example_bank(3, 1, 2);
  bank.R(0, 1) = bank.R(1, 0) = 0.4 * bank.R(0, 0);
  for (const FilterVariant variant : {FilterVariant::imm, FilterVariant::gpb2, FilterVariant::salvi2025}) {
    Trajectory run = simulate_bank(bank, 3, 9);
    run.state(1, 2) = std::nan("");
    const RunEvaluation partial = evaluate_run(bank, run, {variant});
    // The same step with a sensor that has no such signal, from the same start.
    BankFilter filter(bank, {variant}), reduced(measuring(bank, {0, 2}), {variant});
    filter.step(0.0, run.input.col(0), run.state.col(0));
    filter.step(1.0, run.input.col(1), run.state.col(1));
    reduced.step(0.0, run.input.col(0), run.state.col(0)(std::vector<int>{0, 2}));
    reduced.step(1.0, run.input.col(1), run.state.col(1)(std::vector<int>{0, 2}));
    FilterSnapshot snapshot = reduced.snapshot();
    const FilterSnapshot whole = filter.snapshot();
    snapshot.means = whole.means;
    snapshot.covariances = whole.covariances;
    snapshot.mode_probability = whole.mode_probability;
    reduced.restore(snapshot);
    const FilterEstimate& e = reduced.step(2.0, run.input.col(2), run.state.col(2)(std::vector<int>{0, 2}));
    EXPECT_TRUE(near(partial.state.col(2), e.state, rounding)) << name_of(variant);
    EXPECT_TRUE(near(partial.covariance.col(2), e.covariance.reshaped(), rounding));
    EXPECT_TRUE(near(partial.mode_probability.col(2), e.mode_probability, rounding));
    EXPECT_NEAR(partial.log_density(2), e.log_density, rounding * 10);
    EXPECT_NEAR(partial.nis(2), e.nis, rounding * 10);
    EXPECT_TRUE(near(partial.pit.col(2), Eigen::Vector3d(e.pit(0), std::nan(""), e.pit(1)), rounding));
    EXPECT_TRUE(std::isnan(partial.innovation(1, 2)) && !std::isnan(partial.innovation(2, 2)));
  }
}

TEST(TimeSteps, ALongerTimeIsSeveralPredictionsWithTheInputHeld) {
  Bank bank = example_bank(2, 1, 3);
  bank.dt_s = 0.1;
  Trajectory run = simulate_bank(bank, 12, 13), every = run;
  run.time_s *= 0.1;
  // The run that had all samples, but measured nothing at two of them and held the input.
  every.time_s = run.time_s;
  every.state.middleCols(5, 2).setConstant(std::nan(""));
  every.input.col(5) = every.input.col(6) = every.input.col(4);
  Trajectory gap = run;
  const std::vector<int> kept{0, 1, 2, 3, 4, 7, 8, 9, 10, 11};
  gap.time_s = run.time_s(kept).eval();
  gap.state = run.state(Eigen::all, kept).eval();
  gap.input = run.input(Eigen::all, kept).eval();
  for (const FilterVariant variant : {FilterVariant::imm, FilterVariant::gpb1, FilterVariant::gpb2}) {
    const RunEvaluation filled = evaluate_run(bank, every, {variant}), short_run = evaluate_run(bank, gap, {variant});
    EXPECT_TRUE(near(short_run.state.rightCols(5), filled.state.rightCols(5), rounding)) << name_of(variant);
    EXPECT_TRUE(near(short_run.log_density.tail(5), filled.log_density.tail(5), rounding * 10));
    EXPECT_NEAR(log_likelihood(bank, gap, {variant}), log_likelihood(bank, every, {variant}), 1e-10);
  }
  // Who does not look at the clock takes one step.
  Trajectory steady = gap;
  steady.time_s = run.time_s.head(10);
  const FilterOptions single{FilterVariant::imm, false, TimeSteps::single};
  EXPECT_TRUE(near(evaluate_run(bank, gap, single).state, evaluate_run(bank, steady, imm).state, 0.0));
  EXPECT_FALSE(near(evaluate_run(bank, gap, imm).state, evaluate_run(bank, steady, imm).state, 1e-6));
}

TEST(TimeSteps, AVeryLongTimeIsANewStart) {
  Bank bank = example_bank(2, 1, 3);
  bank.dt_s = 1.0;
  Trajectory run = simulate_bank(bank, 12, 13), tail = run;
  run.time_s.tail(5).array() += longest_gap_steps;
  tail.time_s = run.time_s.tail(5).eval();
  tail.state = run.state.rightCols(5).eval();
  tail.input = run.input.rightCols(5).eval();
  const RunEvaluation all = evaluate_run(bank, run, imm), fresh = evaluate_run(bank, tail, imm);
  EXPECT_TRUE(std::isnan(all.log_density(7)));
  EXPECT_TRUE(near(all.state.rightCols(5), fresh.state, 0.0));
  EXPECT_TRUE(near(all.log_density.tail(5), fresh.log_density, 0.0));
}

TEST(BankFilter, GoesOnFromASnapshotAsIfNothingHadHappened) {
  Bank bank = example_bank(2, 1, 3);
  const Trajectory run = simulate_bank(bank, 20, 14);
  for (const FilterVariant variant : {FilterVariant::imm, FilterVariant::gpb2, FilterVariant::kf}) {
    BankFilter first(bank, {variant}), second(bank, {variant});
    for (Eigen::Index k = 0; k < 10; ++k) first.step(run.time_s(k), run.input.col(k), run.state.col(k));
    second.restore(first.snapshot());
    for (Eigen::Index k = 10; k < 20; ++k) {
      const FilterEstimate& a = first.step(run.time_s(k), run.input.col(k), run.state.col(k));
      const FilterEstimate& b = second.step(run.time_s(k), run.input.col(k), run.state.col(k));
      EXPECT_EQ(a.log_density, b.log_density);
      EXPECT_TRUE(near(a.state, b.state, 0.0));
    }
  }
  BankFilter other(example_bank(2, 1, 2), {});
  EXPECT_THROW(other.restore(BankFilter(bank, {}).snapshot()), std::invalid_argument);
}

TEST(Gpb, OneModeIsTheKalmanFilterAndIdenticalModesAreOneFilter) {
  for (const FilterVariant variant : {FilterVariant::gpb1, FilterVariant::gpb2}) {
    const Bank one = single_mode(example_bank(2, 1, 2), 1);
    const Trajectory run = simulate_bank(one, 60, 3);
    expect_same_estimates(evaluate_run(one, run, {variant}), evaluate_run(one, run, imm));
    Bank same = example_bank(3, 2, 3);
    same.modes[1] = same.modes[2] = same.modes[0];
    const Trajectory other = simulate_bank(same, 60, 4);
    expect_same_estimates(evaluate_run(same, other, {variant}), evaluate_run(same, other, kf));
  }
}

TEST(Gpb2, IsExactForTwoSteps) {
  // All histories of two steps, each a Kalman filter of its own: GPB2 merges only after the second.
  const Bank bank = example_bank(2, 1, 3);
  const Trajectory run = simulate_bank(bank, 3, 15);
  double evidence = 0.0, first = 0.0;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      Bank path = single_mode(bank, i);
      BankFilter filter(path, kf);
      filter.step(0.0, run.input.col(0), run.state.col(0));
      const double l1 = filter.step(1.0, run.input.col(1), run.state.col(1)).log_density;
      BankFilter second(single_mode(bank, j), kf);
      second.restore(filter.snapshot());
      const double l2 = second.step(2.0, run.input.col(2), run.state.col(2)).log_density;
      double c = 0.0;
      for (Eigen::Index h = 0; h < 3; ++h)
        c += bank.initial_probability(h) * bank.transition.matrix()(h, static_cast<Eigen::Index>(i));
      evidence +=
          c * bank.transition.matrix()(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) * std::exp(l1 + l2);
      if (j == 0) first += c * std::exp(l1);
    }
  const RunEvaluation gpb2 = evaluate_run(bank, run, {FilterVariant::gpb2});
  EXPECT_NEAR(gpb2.log_density(1), std::log(first), rounding * 10);
  EXPECT_NEAR(gpb2.log_density(2), std::log(evidence) - std::log(first), rounding * 10);
}

TEST(LogLikelihood, IsTheSumOfLogDensities) {
  for (const Eigen::Index n : {1, 2, 3, 4})
    for (const FilterVariant variant : {FilterVariant::imm, FilterVariant::mmae, FilterVariant::gpb1,
                                        FilterVariant::gpb2, FilterVariant::salvi2025}) {
      const Bank bank = example_bank(n, 1, 3);
      Trajectory run = simulate_bank(bank, 50, 10);
      run.state(0, 20) = std::nan("");
      const RunEvaluation result = evaluate_run(bank, run, {variant, true});
      double sum = 0.0;
      for (const double value : result.log_density) sum += std::isnan(value) ? 0.0 : value;
      EXPECT_EQ(log_likelihood(bank, run, {variant, true}), sum);
    }
}

TEST(EvaluateRun, RejectsWhatDoesNotFit) {
  const Bank bank = example_bank(2, 1, 2);
  Trajectory run = simulate_bank(bank, 10, 11);
  Bank wrong = bank;
  wrong.modes[1].Q.resize(1, 1);
  EXPECT_THROW(evaluate_run(wrong, run, imm), std::invalid_argument);
  wrong = bank;
  wrong.transition = TransitionMatrix::sticky(3, 0.9);
  EXPECT_THROW(evaluate_run(wrong, run, imm), std::invalid_argument);
  EXPECT_THROW(evaluate_run(example_bank(2, 2, 2), run, imm), std::invalid_argument);
  EXPECT_THROW(evaluate_run(example_bank(1, 1, 2), run, imm), std::invalid_argument);
  run.input(0, 4) = std::nan("");
  EXPECT_THROW(evaluate_run(bank, run, imm), DataError);
}

}  // namespace
}  // namespace modebank
