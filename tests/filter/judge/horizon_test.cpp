// Predictions some samples ahead: by banks, by banks with lags, and by the drifting model.
#include "filter/judge/horizon.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "filter/step/drifting.hpp"
#include "ident/base/linalg.hpp"
#include "tests/filter/drifting_test_support.hpp"
#include "tests/filter/filter_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using test::example_bank;
using test::example_drifting;
using test::near;
using test::simulate_bank;
using test::simulate_drifting;
using test::single_mode;

TEST(Horizon, OneSampleAheadIsWhatTheFilterSays) {
  for (const Index n : {1, 2}) {
    const Bank modes = example_bank(n, 1, 3);
    Bank rounded = modes, drifting = example_drifting(n, 1, 2);
    rounded.quantum.setConstant(n, 0.05);
    drifting.modes.front().model.A(0, 0) = 0.4;  // unstable
    drifting.running_noise.horizon_factor = {{2, 3.0}};
    Trajectory run = simulate_bank(modes, 150, 26);
    run.state = 0.05 * (run.state / 0.05).array().round();
    run.state.col(30).setConstant(std::nan(""));
    for (const Bank& bank : {modes, single_mode(modes, 0), rounded, drifting, test::with_levels(drifting)}) {
      const bool drifts = !bank.drift.empty();
      const FilterOptions options{bank.mode_count() > 1 || drifts ? FilterVariant::imm : FilterVariant::kf};
      const RunEvaluation e = evaluate_run(bank, run, options);
      const HorizonEvaluation h = evaluate_horizons(bank, run, options, {4, 1});
      EXPECT_EQ(h.horizons, (std::vector<Index>{1, 4}));
      EXPECT_TRUE(near(h.error[0], e.innovation, drifts ? 1e-10 : 1e-14));
      EXPECT_TRUE(near(h.log_density.row(0), e.log_density.transpose(), drifts ? 1e-10 : 1e-12));
      EXPECT_TRUE(bank.is_quantised() || drifts || near(h.pit[0].row(0), e.pit.row(0), 1e-12));
      const Index first = 4 + bank.structure.first_transition();
      EXPECT_TRUE(std::isnan(h.log_density(1, first - 1)) && !std::isnan(h.log_density(1, first)));
    }
  }
}

TEST(Horizon, SeveralSamplesAheadIsTheModelRunOn) {
  const Bank bank = single_mode(example_bank(2, 1, 2), 1);
  const Trajectory run = simulate_bank(bank, 40, 27);
  const HorizonEvaluation h = evaluate_horizons(bank, run, {}, {5});
  const RunEvaluation e = evaluate_run(bank, run, {});
  const Mode& mode = bank.modes[0];
  const Eigen::Matrix2d F = mode.model.full_form();
  for (Index k = 0; k + 5 < 40; ++k) {
    Eigen::Vector2d x = e.state.col(k);
    Eigen::Matrix2d P = e.covariance.col(k).reshaped(2, 2);
    for (Index i = 0; i < 5; ++i) {
      x = mode.model.next(x, run.input.col(k + i));
      P = F * P * F.transpose() + mode.Q;
    }
    const Eigen::Matrix2d S = P + bank.R;
    const Eigen::Vector2d error = run.state.col(k + 5) - x;
    EXPECT_TRUE(near(h.error[0].col(k + 5), error, 1e-12));
    for (Index i = 0; i < 2; ++i)
      EXPECT_NEAR(h.pit[0](i, k + 5), 0.5 * std::erfc(-error(i) / std::sqrt(2.0 * S(i, i))), 1e-12);
    EXPECT_NEAR(h.log_density(0, k + 5),
                -std::log(2 * M_PI) - 0.5 * std::log(S.determinant()) - 0.5 * error.dot(S.inverse() * error), 1e-10);
  }
}

TEST(Horizon, ARowOfAllRunsPoolsTheirSamples) {
  const Bank bank = example_bank(1, 1, 2);
  std::vector<Trajectory> runs{simulate_bank(bank, 30, 28), simulate_bank(bank, 50, 29)};
  runs[1].run = "other";
  std::vector<std::vector<HorizonSums>> sums;
  for (const Trajectory& run : runs) sums.push_back(sum_horizons(evaluate_horizons(bank, run, {}, {10})));
  const std::vector<HorizonRow> rows = summarize_horizons("bank", runs, sums);
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[2].samples, 20 + 40);
  const auto pooled = [](double of_first, double of_second) { return (20 * of_first + 40 * of_second) / 60; };
  EXPECT_NEAR(rows[2].log_score, pooled(rows[0].log_score, rows[1].log_score), 1e-12);
  EXPECT_NEAR(rows[2].coverage_95, pooled(rows[0].coverage_95, rows[1].coverage_95), 1e-12);
  EXPECT_NEAR(rows[2].rmse(0), std::sqrt(pooled(std::pow(rows[0].rmse(0), 2), std::pow(rows[1].rmse(0), 2))), 1e-12);
}

/// Two states with three lags each. `rounding`: deviation of the shift rows from exact shifts.
Bank lagged_bank(double R, double rounding = 0.0) {
  Bank bank = example_bank(2, 1, 3, R);
  const LinearStructure one_lag = bank.structure;
  bank.structure.state_lags = 3;
  bank.C = Eigen::MatrixXd::Identity(2, 6);
  for (Mode& mode : bank.modes) {
    Eigen::MatrixXd theta(2, bank.structure.regressors());  // layout of unpack: [A B c] by rows
    theta << mode.model.A, Eigen::MatrixXd::Constant(2, 2, 0.05), Eigen::MatrixXd::Constant(2, 2, -0.04), mode.model.B,
        mode.model.c;
    mode.model = unpack(bank.structure, Eigen::MatrixXd(theta.transpose()).reshaped());
    mode.model.A.bottomRows(4).array() += rounding;
    Eigen::MatrixXd Q = Eigen::MatrixXd::Zero(6, 6);
    Q.topLeftCorner(one_lag.states, one_lag.states) = mode.Q;
    mode.Q = Q;
    mode.parameter_covariance = {};
  }
  return bank;
}

void expect_alike(const Bank& a, const Bank& b, double off) {
  Trajectory run = simulate_bank(example_bank(2, 1, 3), 120, 31);
  run.state.col(30).setConstant(std::nan(""));
  run.state(0, 60) = std::nan("");
  const RunEvaluation left = evaluate_run(a, run, {}), right = evaluate_run(b, run, {});
  const auto of = [](const Eigen::MatrixXd& rows) { return Eigen::MatrixXd(rows.rightCols(rows.cols() - 3)); };
  EXPECT_TRUE(near(of(left.prediction + left.innovation), of(run.state), 1e-12)) << "estimates hold the sample alone";
  EXPECT_TRUE(near(of(left.state), of(right.state), off));
  EXPECT_TRUE(near(of(left.covariance), of(right.covariance), off));
  EXPECT_TRUE(near(of(left.mode_probability), of(right.mode_probability), off * 1e2));
  EXPECT_TRUE(near(of(evaluate_horizons(a, run, {}, {1, 5}).log_density),
                   of(evaluate_horizons(b, run, {}, {1, 5}).log_density), off * 1e3));
}

/// If lag rows are exact shifts, products use shorter loops. Exactly measured states are known, and computations are
/// skipped: the result must be the limit for measurement noise that goes to zero.
TEST(LaggedStates, ThatShiftOrAreMeasuredExactlyAreThoseOfAnyRows) {
  expect_alike(lagged_bank(1e-4), lagged_bank(1e-4, 1e-14), 1e-10);
  expect_alike(lagged_bank(0.0), lagged_bank(1e-13), 1e-7);
}

constexpr double ahead_digits = 1e-10;

/// If the model is correct and drifts slowly, errors have the predicted variance. 40,000 values: because of their
/// autocorrelation they are worth less, but at least a tenth of that number. Six standard errors are allowed.
TEST(DriftingHorizon, ErrorsAreAsLargeAsStated) {
  Bank model = example_drifting(2, 1, 2);
  model.drift.rates = {2e-3, 0.05, 0.98};
  model.running_noise.lam = 1.0;
  model.running_noise.nu = 0.0;
  Eigen::Array2d squares = Eigen::Array2d::Zero(), count = squares;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const std::vector<LevelErrors> errors = level_errors(model, simulate_drifting(model, 2000, seed), {2, 6});
    for (Index h = 0; h < 2; ++h) {
      const Eigen::ArrayXXd u = errors[h].whitened;
      squares(h) += u.isNaN().select(0.0, u.square()).sum();
      count(h) += static_cast<double>((!u.isNaN()).count());
    }
  }
  EXPECT_TRUE(((squares / count - 1.0).abs() < 6.0 * (2.0 / (0.1 * count)).sqrt()).all());
}

TEST(DriftingHorizon, FactorWidensEveryVariance) {
  Bank model = example_drifting(2, 1, 1);
  model.running_noise.nu = 0.0;
  const Trajectory run = simulate_drifting(model, 50, 5);
  const HorizonEvaluation plain = evaluate_horizons(model, run, {}, {1, 3, 5, 8});
  const std::vector<LevelErrors> errors = level_errors(model, run, {1, 3, 5, 8});
  model.running_noise.horizon_factor = {{3, 4.0}, {8, 0.5}};
  const HorizonEvaluation wide = evaluate_horizons(model, run, {}, {1, 3, 5, 8});
  const std::vector<double> factors{1.0, 4.0, 4.0, 0.5};  // horizon 5 has the factor of horizon 3
  for (Index h = 0; h < 4; ++h)
    for (Index k = 10; k < run.samples(); ++k) {
      const double c = factors[h];
      const double square = errors[h].whitened.col(k).squaredNorm();
      EXPECT_NEAR(wide.log_density(h, k), plain.log_density(h, k) - std::log(c) - 0.5 * square * (1.0 / c - 1.0),
                  ahead_digits);
    }
}

TEST(DriftingHorizon, ContractionDividesEveryRootByTheLargest) {
  std::mt19937_64 generator(3);
  std::normal_distribution<double> normal;
  int unstable = 0;
  for (int repetition = 0; repetition < 40; ++repetition) {
    const LinearStructure s{1 + repetition % 3, 1, true, 1 + repetition % 4, 1, 1};
    const Eigen::VectorXd scale = Eigen::VectorXd::LinSpaced(s.regressors(), 0.5, 2.0);
    Eigen::MatrixXd theta(s.regressors(), s.states);
    for (double& value : theta.reshaped()) value = 0.6 * normal(generator);
    const auto roots = [&](const Eigen::MatrixXd& scaled) {
      const Eigen::MatrixXd physical = scale.cwiseInverse().asDiagonal() * scaled;
      Eigen::VectorXd moduli = eigenvalues(unpack(s, Eigen::VectorXd(physical.reshaped())).full_form()).cwiseAbs();
      std::sort(moduli.begin(), moduli.end());
      return moduli;
    };
    const Eigen::MatrixXd result = contracted(s, scale, theta);
    const double largest = roots(theta).tail(1)(0);
    unstable += largest > 1.0 ? 1 : 0;
    EXPECT_TRUE(largest > 1.0 || result == theta);
    EXPECT_TRUE(near(roots(result), roots(theta) / std::max(1.0, largest), 1e-9));
    EXPECT_EQ(result.bottomRows(2), theta.bottomRows(2)) << "inputs and intercept stay";
  }
  EXPECT_GT(unstable, 10);
  EXPECT_LT(unstable, 40);
}

}  // namespace
}  // namespace modebank
