// Laws that every filter bank must obey, whatever its numbers.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <stdexcept>

#include "modebank/base/error.hpp"
#include "modebank/judge/evaluate.hpp"
#include "tests/filter/public_bank.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using filter::BankDescription;
using test::example_description;
using test::near;
using test::single_mode;

/// Tolerance for two computations of a number of order one in double precision.
constexpr double law_rounding = 1e-12;
constexpr FilterOptions imm{}, kf{FilterVariant::kf};

judge::Evaluation evaluate(const BankDescription& bank, const RecordedRun& run, const FilterOptions& options) {
  return judge::evaluate_run(filter::Bank(bank), run, options);
}

RecordedRun simulate(const BankDescription& bank, Eigen::Index samples, std::uint64_t seed) {
  return test::simulate_description(bank, samples, seed).run;
}

void expect_same_estimates(const judge::Evaluation& a, const judge::Evaluation& b) {
  EXPECT_TRUE(near(view(a.prediction), view(b.prediction), law_rounding));
  EXPECT_TRUE(near(view(a.innovation_covariance), view(b.innovation_covariance), law_rounding));
  EXPECT_TRUE(near(view(a.state), view(b.state), law_rounding));
  EXPECT_TRUE(near(view(a.covariance), view(b.covariance), law_rounding));
  // Log densities have sizes up to about ten.
  EXPECT_TRUE(near(view(a.log_density), view(b.log_density), law_rounding * 10));
  EXPECT_TRUE(near(view(a.pit), view(b.pit), law_rounding));
}

TEST(Imm, EqualLikelihoodsLeaveThePredictedProbabilities) {
  BankDescription bank = example_description(1, 2, 2);
  bank.modes[1] = bank.modes[0];
  bank.transition = {{0.95, 0.05}, {0.10, 0.90}};
  bank.initial_probability = {0.7, 0.3};
  const RecordedRun run = simulate(bank, 2, 1);
  // 0.7 * 0.95 + 0.3 * 0.10 = 0.695; with rows and columns swapped it would be 0.68.
  const Eigen::Vector2d expected(0.695, 0.305);
  EXPECT_TRUE(near(test::predicted_probabilities(filter::Bank(bank), run, imm).col(1), expected, law_rounding));
  EXPECT_TRUE(near(view(evaluate(bank, run, imm).mode_probability).col(1), expected, law_rounding));
}

TEST(Imm, IdenticalModesAreOneFilter) {
  for (const Eigen::Index n : {1, 2, 4}) {
    BankDescription bank = example_description(n, 2, 3);
    bank.modes[1] = bank.modes[2] = bank.modes[0];
    const RecordedRun run = simulate(bank, 60, 2);
    expect_same_estimates(evaluate(bank, run, imm), evaluate(single_mode(bank, 0), run, kf));
  }
}

TEST(Imm, OneModeIsTheKalmanFilter) {
  const BankDescription bank = single_mode(example_description(2, 1, 2), 1);
  const RecordedRun run = simulate(bank, 60, 3);
  expect_same_estimates(evaluate(bank, run, imm), evaluate(bank, run, kf));
}

/// The modes are equal, so any choice between them would be arbitrary.
TEST(Kf, RefusesSeveralModes) {
  const BankDescription bank = example_description(1, 2, 3);
  const RecordedRun run = simulate(bank, 60, 3);
  EXPECT_THROW(filter::BankFilter(filter::Bank(bank), kf), std::invalid_argument);
  EXPECT_THROW(evaluate(bank, run, kf), std::invalid_argument);
  EXPECT_THROW(judge::log_likelihood(filter::Bank(bank), run, kf), std::invalid_argument);
  EXPECT_NO_THROW(evaluate(single_mode(bank, 2), run, kf));
}

TEST(Imm, ProbabilitiesSumToOne) {
  const BankDescription bank = example_description(2, 1, 4);
  const RecordedRun run = simulate(bank, 200, 4);
  for (const FilterVariant variant : {FilterVariant::imm, FilterVariant::salvi2025}) {
    const Eigen::MatrixXd after = view(evaluate(bank, run, {variant}).mode_probability);
    const Eigen::MatrixXd before = test::predicted_probabilities(filter::Bank(bank), run, {variant});
    EXPECT_TRUE(near(after.colwise().sum(), Eigen::RowVectorXd::Ones(200), law_rounding));
    EXPECT_TRUE(near(before.colwise().sum(), Eigen::RowVectorXd::Ones(200), law_rounding));
    EXPECT_GE(after.minCoeff(), 0.5e-12);  // no probability falls below 1e-12 before they are normalised
  }
}

/// Multiple model adaptive estimation (Magill 1965): modes that never switch (bank.stay = 1).
TEST(Imm, ThatNeverSwitchesIsBayesRuleOverSeparateFilters) {
  BankDescription bank = example_description(2, 1, 3);
  for (std::size_t j = 0; j < 3; ++j) bank.modes[j] = bank.modes[0];
  for (std::size_t j = 1; j < 3; ++j)
    for (double& q : bank.modes[j].Q.values) q *= 1.0 + 0.3 * static_cast<double>(j);
  const RecordedRun run = simulate(bank, 40, 5);
  Eigen::MatrixXd log_weight(3, 40);
  for (std::size_t j = 0; j < 3; ++j) {
    const judge::Evaluation alone = evaluate(single_mode(bank, j), run, kf);
    double sum = std::log(bank.initial_probability[j]);
    for (Eigen::Index k = 0; k < 40; ++k)
      log_weight(static_cast<Eigen::Index>(j), k) = sum += k > 0 ? view(alone.log_density)(k) : 0.0;
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

  bank.transition = test::sticky_transition(3, 1.0);
  const judge::Evaluation result = evaluate(bank, run, imm);
  // Tolerances for sums of 40 log densities of order ten.
  EXPECT_TRUE(near(view(result.mode_probability), expected, law_rounding * 100));
  EXPECT_NEAR(view(result.log_density).tail(39).sum(), evidence(39), law_rounding * 1000);
}

TEST(Kf, WithoutProcessNoiseIsBatchLeastSquares) {
  BankDescription bank = single_mode(example_description(2, 1, 1, 0.01), 0);
  bank.modes[0].Q = Matrix(2, 2);
  const RecordedRun run = simulate(bank, 30, 6);
  // y_k = F^k x_0 + d_k + v_k gives normal equations for x_0. The estimate is then propagated to the last sample.
  const filter::Mode& mode = bank.modes[0];
  const Eigen::Matrix2d F = view(mode.A) + Eigen::Matrix2d::Identity(), precision = view(bank.R).inverse();
  Eigen::Matrix2d power = Eigen::Matrix2d::Identity(), information = Eigen::Matrix2d::Zero();
  Eigen::Vector2d offset = Eigen::Vector2d::Zero(), right = Eigen::Vector2d::Zero();
  for (Eigen::Index k = 0; k < 30; ++k) {
    if (k > 0) {
      power = F * power;
      offset = F * offset + view(mode.B) * view(run.input).col(k - 1) + view(mode.c);
    }
    information += power.transpose() * precision * power;
    right += power.transpose() * precision * (view(run.state).col(k) - offset);
  }
  const Eigen::Vector2d x = power * information.inverse() * right + offset;
  const Eigen::Matrix2d P = power * information.inverse() * power.transpose();

  const judge::Evaluation result = evaluate(bank, run, kf);
  EXPECT_TRUE(near(view(result.state).col(29), x, law_rounding));
  EXPECT_TRUE(near(view(result.covariance).col(29), P.reshaped(), law_rounding));
}

TEST(LogLikelihood, IsTheSumOfLogDensities) {
  for (const Eigen::Index n : {1, 2, 3, 4})
    for (const FilterVariant variant : {FilterVariant::imm, FilterVariant::salvi2025}) {
      const BankDescription bank = example_description(n, 1, 3);
      RecordedRun run = simulate(bank, 50, 10);
      run.state(0, 20) = std::nan("");
      const judge::Evaluation result = evaluate(bank, run, {variant});
      double sum = 0.0;
      for (const double value : result.log_density) sum += std::isnan(value) ? 0.0 : value;
      EXPECT_EQ(judge::log_likelihood(filter::Bank(bank), run, {variant}), sum);
    }
}

TEST(EvaluateRun, RejectsWhatDoesNotFit) {
  const BankDescription bank = example_description(2, 1, 2);
  RecordedRun run = simulate(bank, 10, 11);
  BankDescription wrong = bank;
  wrong.modes[1].Q = Matrix(1, 1);
  EXPECT_THROW(evaluate(wrong, run, imm), std::invalid_argument);
  wrong = bank;
  wrong.transition = test::sticky_transition(3, 0.9);
  EXPECT_THROW(evaluate(wrong, run, imm), std::invalid_argument);
  EXPECT_THROW(evaluate(example_description(2, 2, 2), run, imm), std::invalid_argument);
  EXPECT_THROW(evaluate(example_description(1, 1, 2), run, imm), std::invalid_argument);
  run.input(0, 4) = std::nan("");
  EXPECT_THROW(evaluate(bank, run, imm), DataError);
}

}  // namespace
}  // namespace modebank
