// Laws that every filter bank must obey, whatever its numbers.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <stdexcept>

#include "filter/judge/run/evaluate.hpp"
#include "filter/step/bank_filter.hpp"
#include "filter/step/equations/imm.hpp"
#include "modebank/base/error.hpp"
#include "tests/filter/filter_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using test::example_bank;
using test::near;
using test::simulate_bank;
using test::single_mode;

/// Tolerance for two computations of a number of order one in double precision.
constexpr double law_rounding = 1e-12;
constexpr FilterOptions imm{}, kf{FilterVariant::kf};

void expect_same_estimates(const RunEvaluation& a, const RunEvaluation& b) {
  EXPECT_TRUE(near(a.prediction, b.prediction, law_rounding));
  EXPECT_TRUE(near(a.innovation_covariance, b.innovation_covariance, law_rounding));
  EXPECT_TRUE(near(a.state, b.state, law_rounding));
  EXPECT_TRUE(near(a.covariance, b.covariance, law_rounding));
  EXPECT_TRUE(near(a.log_density, b.log_density, law_rounding * 10));  // log densities have sizes up to about ten
  EXPECT_TRUE(near(a.pit, b.pit, law_rounding));
}

/// Products for lagged samples skip factors that are zero or one.
TEST(SmallProducts, OfShiftsAndOfPartsThatAreSeenHaveThePlainOnesBits) {
  const Eigen::Index n = 7, full = 2;
  Eigen::MatrixXd F = Eigen::MatrixXd::Zero(n, n), gain = Eigen::MatrixXd::Random(n, full), P(n, n);
  F.topRows(full) = Eigen::MatrixXd::Random(full, n);
  for (Eigen::Index i = full; i < n; ++i) F(i, i - full) = 1.0;
  const Eigen::MatrixXd root = Eigen::MatrixXd::Random(n, n);
  P = root * root.transpose();
  Eigen::MatrixXd closed = Eigen::MatrixXd::Identity(n, n);
  closed.leftCols(full) -= gain;
  Eigen::MatrixXd plain(n, n), quick(n, n), plain_sum = P, quick_sum = P;
  small::multiply(plain, F, P);
  small::multiply_shifting(quick, F, P, full, P.rows());
  EXPECT_EQ(plain, quick);
  small::add_symmetric_product(plain_sum, plain, F);
  small::add_symmetric_product_shifting(quick_sum, quick, F, full, P.rows());
  EXPECT_EQ(plain_sum, quick_sum);
  small::multiply(plain, closed, P);
  small::multiply_seeing(quick, closed, P, full);
  EXPECT_EQ(plain, quick);
  small::add_symmetric_product(plain_sum, plain, closed);
  small::add_symmetric_product_seeing(quick_sum, quick, closed, full);
  EXPECT_EQ(plain_sum, quick_sum);
}

/// If only the newest samples are uncertain, the other entries of a product are zero.
TEST(SmallProducts, OfAPartThatIsUncertainAreThoseOfTheWhole) {
  const Eigen::Index n = 7, full = 2, uncertain = 3;
  Eigen::MatrixXd F = Eigen::MatrixXd::Zero(n, n), P = Eigen::MatrixXd::Zero(n, n);
  F.topRows(full) = Eigen::MatrixXd::Random(full, n);
  for (Eigen::Index i = full; i < n; ++i) F(i, i - full) = 1.0;
  const Eigen::MatrixXd root = Eigen::MatrixXd::Random(uncertain, uncertain);
  P.topLeftCorner(uncertain, uncertain) = root * root.transpose();
  Eigen::MatrixXd product = Eigen::MatrixXd::Constant(n, n, 7.0), sum = Eigen::MatrixXd::Zero(n, n);
  small::multiply_shifting(product, F, P, full, uncertain);
  small::add_symmetric_product_shifting(sum, product, F, full, uncertain);
  EXPECT_TRUE(near(sum, Eigen::MatrixXd(F * P * F.transpose()), law_rounding));
}

TEST(MixingWeights, PredictedProbabilitiesFollowTheRowsOfTheTransitionMatrix) {
  // 0.7 * 0.95 + 0.3 * 0.10 = 0.695; with rows and columns swapped it would be 0.68.
  const TransitionMatrix T((Eigen::MatrixXd(2, 2) << 0.95, 0.05, 0.10, 0.90).finished());
  Eigen::VectorXd c(2);
  MixingWeights weights{Eigen::MatrixXd(2, 2)};
  mixing_weights(T.matrix(), Eigen::Vector2d(0.7, 0.3), c, weights);
  EXPECT_TRUE(near(c, Eigen::Vector2d(0.695, 0.305), law_rounding));
  EXPECT_TRUE(near(weights.matrix.colwise().sum(), Eigen::RowVector2d::Ones(), law_rounding));
  EXPECT_NEAR(weights.matrix(1, 0), 0.3 * 0.10 / 0.695, law_rounding);
}

TEST(Imm, EqualLikelihoodsLeaveThePredictedProbabilities) {
  Bank bank = example_bank(1, 2, 2);
  bank.modes[1] = bank.modes[0];
  bank.transition = TransitionMatrix((Eigen::MatrixXd(2, 2) << 0.95, 0.05, 0.10, 0.90).finished());
  bank.initial_probability << 0.7, 0.3;
  const RunEvaluation result = evaluate_run(bank, simulate_bank(bank, 2, 1), imm);
  EXPECT_TRUE(near(result.mode_probability_predicted.col(1), Eigen::Vector2d(0.695, 0.305), law_rounding));
  EXPECT_TRUE(near(result.mode_probability.col(1), Eigen::Vector2d(0.695, 0.305), law_rounding));
}

TEST(Imm, IdenticalModesAreOneFilter) {
  for (const Eigen::Index n : {1, 2, 4}) {
    Bank bank = example_bank(n, 2, 3);
    bank.modes[1] = bank.modes[2] = bank.modes[0];
    const Trajectory run = simulate_bank(bank, 60, 2);
    expect_same_estimates(evaluate_run(bank, run, imm), evaluate_run(single_mode(bank, 0), run, kf));
  }
}

TEST(Imm, OneModeIsTheKalmanFilter) {
  const Bank bank = single_mode(example_bank(2, 1, 2), 1);
  const Trajectory run = simulate_bank(bank, 60, 3);
  expect_same_estimates(evaluate_run(bank, run, imm), evaluate_run(bank, run, kf));
}

/// The modes are equal, so any choice between them would be arbitrary.
TEST(Kf, RefusesSeveralModes) {
  const Bank bank = example_bank(1, 2, 3);
  const Trajectory run = simulate_bank(bank, 60, 3);
  EXPECT_THROW(BankFilter(bank, kf), std::invalid_argument);
  EXPECT_THROW(evaluate_run(bank, run, kf), std::invalid_argument);
  EXPECT_THROW(log_likelihood(bank, run, kf), std::invalid_argument);
  EXPECT_NO_THROW(evaluate_run(single_mode(bank, 2), run, kf));
}

TEST(Imm, ProbabilitiesSumToOne) {
  const Bank bank = example_bank(2, 1, 4);
  const Trajectory run = simulate_bank(bank, 200, 4);
  for (const FilterVariant variant : {FilterVariant::imm, FilterVariant::salvi2025}) {
    const RunEvaluation result = evaluate_run(bank, run, {variant});
    EXPECT_TRUE(near(result.mode_probability.colwise().sum(), Eigen::RowVectorXd::Ones(200), law_rounding));
    EXPECT_TRUE(near(result.mode_probability_predicted.colwise().sum(), Eigen::RowVectorXd::Ones(200), law_rounding));
    EXPECT_GE(result.mode_probability.minCoeff(), 0.5 * mode_probability_floor);
  }
}

/// Multiple model adaptive estimation (Magill 1965): modes that never switch (bank.stay = 1).
TEST(Imm, ThatNeverSwitchesIsBayesRuleOverSeparateFilters) {
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

  bank.transition = TransitionMatrix::sticky(3, 1.0);
  const RunEvaluation result = evaluate_run(bank, run, imm);
  EXPECT_TRUE(near(result.mode_probability, expected, law_rounding * 100));  // tolerance for sums of 40 log densities
                                                                             // of order ten
  EXPECT_NEAR(result.log_density.tail(39).sum(), evidence(39), law_rounding * 1000);
}

TEST(Kf, WithoutProcessNoiseIsBatchLeastSquares) {
  Bank bank = single_mode(example_bank(2, 1, 1, 0.01), 0);
  bank.modes[0].Q.setZero();
  const Trajectory run = simulate_bank(bank, 30, 6);
  // y_k = F^k x_0 + d_k + v_k gives normal equations for x_0. The estimate is then propagated to the last sample.
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
  EXPECT_TRUE(near(result.state.col(29), x, law_rounding));
  EXPECT_TRUE(near(result.covariance.col(29), P.reshaped(), law_rounding));
}

TEST(LogLikelihood, IsTheSumOfLogDensities) {
  for (const Eigen::Index n : {1, 2, 3, 4})
    for (const FilterVariant variant : {FilterVariant::imm, FilterVariant::salvi2025}) {
      const Bank bank = example_bank(n, 1, 3);
      Trajectory run = simulate_bank(bank, 50, 10);
      run.state(0, 20) = std::nan("");
      const RunEvaluation result = evaluate_run(bank, run, {variant});
      double sum = 0.0;
      for (const double value : result.log_density) sum += std::isnan(value) ? 0.0 : value;
      EXPECT_EQ(log_likelihood(bank, run, {variant}), sum);
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
