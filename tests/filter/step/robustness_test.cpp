// The filter must not return NaN for any input.
#include <gtest/gtest.h>

#include "filter/judge/evaluate.hpp"
#include "filter/step/bank_filter.hpp"
#include "tests/filter/drifting_test_support.hpp"
#include "tests/filter/filter_test_support.hpp"
#include "tests/support/effort.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using test::example_bank;
using test::simulate_bank;

using Eigen::Index;

constexpr FilterVariant all_variants[] = {FilterVariant::imm, FilterVariant::salvi2025, FilterVariant::kf};

/// If no measurement is missing, all numbers from sample 1 on must be finite, and no variance negative.
void expect_finite(const Bank& modes, const Trajectory& run, const std::string& what) {
  for (const FilterVariant variant : all_variants) {
    SCOPED_TRACE(what + ", " + std::string(name_of(variant)));
    const RunEvaluation r = evaluate_run(test::steppable(modes, variant), run, {variant});
    const Index scored = run.samples() - 1, n = r.state.rows();
    EXPECT_TRUE(r.prediction.rightCols(scored).allFinite());
    EXPECT_TRUE(r.innovation_covariance.rightCols(scored).allFinite());
    EXPECT_TRUE(r.state.allFinite() && r.covariance.allFinite());
    EXPECT_TRUE(r.nis.tail(scored).allFinite() && r.log_density.tail(scored).allFinite());
    EXPECT_TRUE((r.pit.rightCols(scored).array() >= 0.0).all() && (r.pit.rightCols(scored).array() <= 1.0).all());
    EXPECT_TRUE(r.mode_probability.allFinite() && r.mode_probability_predicted.allFinite());
    for (Index i = 0; i < n; ++i) EXPECT_GE(r.covariance.row(i * n + i).minCoeff(), 0.0);
  }
}

TEST(NeverNaN, OutliersOfAMillionSigma) {
  for (const Index n : {1, 2, 4}) {
    const Bank bank = example_bank(n, 1, 3);
    Trajectory run = simulate_bank(bank, 40, 1);
    run.state.col(10).setConstant(1e6 * std::sqrt(bank.R(0, 0)));
    run.state(0, 20) = -1e6;
    run.state(n - 1, 30) = 1e29;
    expect_finite(bank, run, "outliers, n = " + std::to_string(n));
  }
}

TEST(NeverNaN, ADeadMode) {
  Bank bank = example_bank(1, 2, 3, 1e-12);  // almost no measurement noise
  bank.initial_probability << 1.0, 0.0, 0.0;
  bank.transition = TransitionMatrix(Eigen::MatrixXd{{0.9, 0.1, 0}, {0.2, 0.8, 0}, {0.5, 0.5, 0}});
  expect_finite(bank, simulate_bank(bank, 40, 3), "mode that no other leads to");
}

/// S becomes singular without measurement noise, if the process noise has rank one or zero.
TEST(NeverNaN, SingularNoise) {
  for (const Index n : {2, 3})
    for (const double q : {1e-4, 0.0})
      for (const double r : {1e-4, 0.0}) {
        Bank bank = example_bank(n, 1, 3);
        Trajectory run = simulate_bank(bank, 500, 4);
        run.state.col(200).setConstant(1e6);
        bank.R *= r / 1e-4;
        for (Mode& mode : bank.modes) mode.Q.setConstant(q);
        expect_finite(bank, run, "Q of ones times " + std::to_string(q) + ", R " + std::to_string(r));
      }
}

TEST(NeverNaN, TinyAndHugeUnits) {
  const Bank bank = example_bank(2, 1, 2);
  const Trajectory run = simulate_bank(bank, 40, 5);
  for (const double unit : {1e-9, 1e9}) {
    Bank scaled = bank;
    Trajectory scaled_run = run;
    scaled_run.state *= unit;
    scaled.R *= unit * unit;
    for (Mode& mode : scaled.modes) {
      mode.Q *= unit * unit;
      mode.model.B *= unit;
      mode.model.c *= unit;
    }
    expect_finite(scaled, scaled_run, "unit " + std::to_string(unit));
    // The units of a signal do not change the mode probabilities.
    constexpr double relative = 1e-9;
    EXPECT_TRUE(test::near(evaluate_run(scaled, scaled_run, {}).mode_probability,
                           evaluate_run(bank, run, {}).mode_probability, relative));
  }
}

TEST(NeverNaN, AnUnstableModeWithoutMeasurementsStaysFinite) {
  Bank bank = example_bank(2, 1, 2);
  bank.modes[1].model.A = 2.0 * Eigen::Matrix2d::Identity();
  Trajectory run = simulate_bank(example_bank(2, 1, 2), 3000, 6);
  run.state.middleCols(5, 2900).setConstant(std::nan(""));
  for (const FilterVariant variant : all_variants) {
    const RunEvaluation result = evaluate_run(test::steppable(bank, variant), run, {variant});
    EXPECT_TRUE(result.state.allFinite() && result.covariance.allFinite()) << name_of(variant);
    EXPECT_TRUE(result.log_density.tail(90).allFinite()) << name_of(variant);
  }
}

TEST(NeverNaN, AMillionStepsAtConstantInputInEveryVariant) {
  constexpr Index steps = test::in_release(1'000'000, 20'000);
  Bank bank = example_bank(1, 1, 2);
  bank.modes[1].model.A(0, 0) = 0.0;  // an integrator
  const Eigen::VectorXd u = Eigen::VectorXd::Constant(1, 0.5), y = Eigen::VectorXd::Constant(1, 0.3);
  for (const FilterVariant variant : all_variants) {
    BankFilter filter(test::steppable(bank, variant), {variant});
    for (Index k = 0; k < steps; ++k) filter.step(std::nan(""), u, y);
    const FilterEstimate& e = filter.estimate();
    EXPECT_TRUE(e.state.allFinite() && e.covariance.allFinite() && e.mode_probability.allFinite()) << name_of(variant);
    EXPECT_TRUE(std::isfinite(e.log_density) && std::isfinite(e.nis) && e.pit.allFinite()) << name_of(variant);
    EXPECT_GT(e.covariance(0, 0), 0.0) << name_of(variant);
  }
}

/// Finite weights of any size, which an archive may contain. The log odds of these weights overflow.
TEST(NeverNaN, LogOddsOfAnySize) {
  for (const double weight : {1e3, 1e150, 1e308}) {
    Bank bank = example_bank(2, 2, 3);
    bank.transition_logit = {Eigen::MatrixXd::Constant(3, 4, weight), Eigen::VectorXd::Constant(4, 1.0)};
    bank.transition_logit.weights.row(1) *= -1.0;
    const RunEvaluation r = evaluate_run(bank, simulate_bank(bank, 100, 31), {});
    EXPECT_TRUE(r.log_density.tail(99).allFinite()) << weight;
    EXPECT_TRUE(r.mode_probability.allFinite() && r.mode_probability.minCoeff() >= 0.0) << weight;
  }
}

/// An input overflows the prediction of sample 6: the filter fails there, which is not the missing sample 3. Infinity
/// counts as missing.
TEST(Failure, HasTheLowestDensityAndAMissingSampleHasNone) {
  for (Bank bank : {test::single_mode(example_bank(1, 1, 2), 0), example_bank(1, 1, 2), example_bank(5, 1, 2),
                    test::example_drifting(2, 1, 1)}) {
    Trajectory run = simulate_bank(bank, 10, 7);
    run.input.setZero();
    run.input(0, 5) = 1e300;
    run.state.col(3).setConstant(INFINITY);
    for (Mode& mode : bank.modes) mode.model.B.setConstant(1e100);
    const RunEvaluation actual = evaluate_run(bank, run, {});
    EXPECT_TRUE(std::isnan(actual.log_density(3)));
    EXPECT_GT(actual.log_density(5), lowest_log_density);
    EXPECT_EQ(actual.log_density(6), lowest_log_density);
    EXPECT_LE(log_likelihood(bank, run, {}), lowest_log_density);
  }
}

}  // namespace
}  // namespace modebank
