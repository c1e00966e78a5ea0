// The smoother, the mode sequence and predictions over several steps.
#include "filter/judge/run/smoother.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "filter/judge/run/horizon.hpp"
#include "filter/step/bank_filter.hpp"
#include "tests/filter/filter_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using Eigen::Index;
using test::example_bank;
using test::near;
using test::simulate_bank;
using test::single_mode;

RunEvaluation smoothed(const Bank& bank, const Trajectory& run, const FilterOptions& options = {}) {
  RunEvaluation evaluation = evaluate_run(bank, run, options);
  smooth_run(bank, run, options, evaluation);
  return evaluation;
}

/// Mean and covariance of all states given all measurements. They come from the joint normal density of the run.
struct Batch {
  Eigen::MatrixXd state;                    ///< n x N
  std::vector<Eigen::MatrixXd> covariance;  ///< N
};

Batch solve_batch(const Bank& bank, const Trajectory& run) {
  const Index n = bank.structure.states, N = run.samples();
  const Mode& mode = bank.modes[0];
  const Eigen::MatrixXd F = mode.model.full_form(), Q_inverse = mode.Q.inverse(), R_inverse = bank.R.inverse();
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n * N, n * N);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n * N);
  for (Index k = 0; k < N; ++k) {
    if (!std::isnan(run.state(0, k))) {
      information.block(k * n, k * n, n, n) += bank.C.transpose() * R_inverse * bank.C;
      right.segment(k * n, n) += bank.C.transpose() * R_inverse * run.state.col(k);
    }
    if (k == 0) continue;
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(n, n * N);
    J.middleCols((k - 1) * n, n) = -F;
    J.middleCols(k * n, n).setIdentity();
    information += J.transpose() * Q_inverse * J;
    right += J.transpose() * Q_inverse * (mode.model.B * run.input.col(k - 1) + mode.model.c);
  }
  const Eigen::MatrixXd P = information.inverse();
  Batch batch{(P * right).reshaped(n, N), {}};
  for (Index k = 0; k < N; ++k) batch.covariance.push_back(P.block(k * n, k * n, n, n));
  return batch;
}

TEST(Smoother, OneModeIsTheBatchEstimateOfEveryState) {
  // The batch estimate must equal the estimate of the recursive Rauch-Tung-Striebel smoother.
  for (const Index n : {1, 2, 4}) {
    const Bank bank = single_mode(example_bank(n, 1, 1, 1e-3), 0);
    Trajectory run = simulate_bank(bank, 25, 20);
    run.state.middleCols(11, 3).setConstant(std::nan(""));
    const Batch batch = solve_batch(bank, run);
    for (const FilterVariant variant : {FilterVariant::imm, FilterVariant::kf}) {
      const RunEvaluation e = smoothed(bank, run, {variant});
      EXPECT_TRUE(near(e.smoothed_state, batch.state, 1e-12));
      for (Index k = 0; k < run.samples(); ++k)
        EXPECT_TRUE(
            near(e.smoothed_covariance.col(k).reshaped(n, n), batch.covariance[static_cast<std::size_t>(k)], 1e-12));
      EXPECT_TRUE((e.viterbi_mode.array() == 0).all());
    }
  }
}

TEST(Smoother, IdenticalModesAreOneSmoother) {
  Bank bank = example_bank(2, 1, 3);
  bank.modes[1] = bank.modes[2] = bank.modes[0];
  const Trajectory run = simulate_bank(bank, 40, 21);
  const RunEvaluation one = smoothed(single_mode(bank, 0), run);
  const RunEvaluation e = smoothed(bank, run, {});
  EXPECT_TRUE(near(e.smoothed_state, one.smoothed_state, 1e-12));
  EXPECT_TRUE(near(e.smoothed_covariance, one.smoothed_covariance, 1e-12));
}

TEST(Smoother, KeepsToItsStretchWhereTheFilterStartsAnew) {
  Bank bank = example_bank(1, 1, 2);
  bank.dt_s = 1.0;
  Trajectory run = simulate_bank(bank, 30, 22), head = run;
  head.time_s = run.time_s.head(12).eval();
  head.state = run.state.leftCols(12).eval();
  head.input = run.input.leftCols(12).eval();
  run.time_s.tail(18).array() += 2 * longest_gap_steps;
  const RunEvaluation all = smoothed(bank, run), part = smoothed(bank, head);
  EXPECT_TRUE(near(all.smoothed_state.leftCols(12), part.smoothed_state, 0.0));
  EXPECT_TRUE(near(all.viterbi_mode.head(12).cast<double>(), part.viterbi_mode.cast<double>(), 0.0));
}

TEST(Smoother, StaysFiniteWhereNoiseIsSingular) {
  Bank bank = example_bank(2, 1, 3);
  for (Mode& mode : bank.modes) mode.Q = Eigen::MatrixXd::Constant(2, 2, 1e-4);
  Trajectory run = simulate_bank(bank, 60, 23);
  run.state.col(20).setConstant(1e6);
  for (const double R : {1e-4, 1e-12, 0.0}) {
    bank.R = R * Eigen::Matrix2d::Identity();
    const RunEvaluation e = smoothed(bank, run, {});
    EXPECT_TRUE(e.smoothed_state.allFinite() && e.smoothed_covariance.allFinite()) << R;
  }
}

/// Two states with three lags each. `rounding`: deviation of the shift rows from exact shifts. With a deviation, they
/// are treated like other rows.
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

Trajectory run_with_gaps(std::uint64_t seed) {
  Trajectory run = simulate_bank(example_bank(2, 1, 3), 120, seed);
  run.state.col(30).setConstant(std::numeric_limits<double>::quiet_NaN());
  run.state(0, 60) = std::numeric_limits<double>::quiet_NaN();
  return run;
}

void expect_alike(const Bank& a, const Bank& b, const FilterOptions& options, double off) {
  const Trajectory run = run_with_gaps(31);
  const RunEvaluation left = smoothed(a, run, options), right = smoothed(b, run, options);
  const Index first = 3, count = run.samples() - first;
  const auto of = [&](const Eigen::MatrixXd& rows) { return Eigen::MatrixXd(rows.middleCols(first, count)); };
  for (Index k = first; k < run.samples(); ++k) {
    if (std::isnan(left.log_density(k))) continue;
    EXPECT_NEAR(left.log_density(k), right.log_density(k), off * 1e3) << k;
  }
  EXPECT_TRUE(near(of(left.state), of(right.state), off));
  EXPECT_TRUE(near(of(left.covariance), of(right.covariance), off));
  EXPECT_TRUE(near(of(left.mode_probability), of(right.mode_probability), off * 1e2));
  EXPECT_TRUE(near(of(left.smoothed_state), of(right.smoothed_state), off));
  EXPECT_TRUE(near(of(left.smoothed_covariance), of(right.smoothed_covariance), off));
  const HorizonEvaluation ahead = evaluate_horizons(a, run, options, {1, 5}),
                          other = evaluate_horizons(b, run, options, {1, 5});
  for (Index k = first + 5; k < run.samples(); ++k) {
    if (std::isnan(ahead.log_density(1, k))) continue;
    EXPECT_NEAR(ahead.log_density(1, k), other.log_density(1, k), off * 1e3) << k;
  }
}

/// If lag rows are exact shifts, products use shorter loops.
TEST(LaggedStates, ThatShiftAreThoseOfAnyRows) { expect_alike(lagged_bank(1e-4), lagged_bank(1e-4, 1e-14), {}, 1e-10); }

/// Exactly measured states are known, and the smoother skips computations. The result must be the limit for measurement
/// noise that goes to zero.
TEST(LaggedStates, MeasuredExactlyAreTheLimitOfLittleNoise) {
  expect_alike(lagged_bank(0.0), lagged_bank(1e-13), {}, 1e-7);
}

/// Earlier samples of a lagged state are in earlier columns.
TEST(LaggedStates, EstimatesHoldTheSampleAlone) {
  const Trajectory run = run_with_gaps(33);
  for (const double R : {0.0, 1e-4}) {
    const RunEvaluation e = smoothed(lagged_bank(R), run);
    for (const Eigen::MatrixXd* states : {&e.prediction, &e.state, &e.smoothed_state}) EXPECT_EQ(states->rows(), 2);
    for (const Eigen::MatrixXd* squares : {&e.covariance, &e.smoothed_covariance}) EXPECT_EQ(squares->rows(), 4);
    for (Index k = 3; k < run.samples(); ++k) {
      if (!run.state.col(k).allFinite()) continue;
      EXPECT_TRUE(near(e.prediction.col(k), run.state.col(k) - e.innovation.col(k), 1e-12)) << k;
      if (R > 0.0) continue;
      EXPECT_TRUE(near(e.smoothed_state.col(k), run.state.col(k), 1e-12)) << k;
      EXPECT_TRUE(near(e.smoothed_covariance.col(k), Eigen::VectorXd::Zero(4), 1e-12)) << k;
    }
  }
}

/// The sequence of modes with the highest joint density, of all sequences, for exactly measured states. `scale`: factor
/// on Q, sample by sample.
Eigen::VectorXi best_sequence(const Bank& bank, const Trajectory& run, const Eigen::VectorXd& scale) {
  const int K = static_cast<int>(bank.mode_count()), samples = static_cast<int>(run.samples());
  double best = -1e300;
  Eigen::VectorXi result(samples);
  for (int code = 0; code < std::pow(K, samples); ++code) {
    Eigen::VectorXi s(samples);
    for (int k = 0, rest = code; k < samples; ++k, rest /= K) s(k) = rest % K;
    double value = std::log(bank.initial_probability(s(0)));
    for (Index k = 1; k < samples; ++k) {
      const Mode& mode = bank.modes[static_cast<std::size_t>(s(k))];
      const double e = run.state(0, k) - mode.model.next(run.state.col(k - 1), run.input.col(k - 1))(0);
      const double Q = scale(k) * mode.Q(0, 0);
      value += std::log(bank.transition.matrix()(s(k - 1), s(k))) - 0.5 * (std::log(Q) + e * e / Q);
    }
    if (value > best) {
      best = value;
      result = s;
    }
  }
  return result;
}

TEST(Viterbi, IsTheBestOfAllSequencesWhenTheStateIsMeasuredExactly) {
  Bank bank = example_bank(1, 1, 3, 1e-16);
  bank.transition = TransitionMatrix((Eigen::MatrixXd(3, 3) << 0.7, 0.2, 0.1, 0.1, 0.8, 0.1, 0.3, 0.1, 0.6).finished());
  bank.initial_probability << 0.5, 0.3, 0.2;
  const Trajectory run = simulate_bank(bank, 8, 24);
  const Eigen::VectorXi expected = best_sequence(bank, run, Eigen::VectorXd::Ones(8));
  for (const FilterVariant variant : {FilterVariant::imm, FilterVariant::salvi2025})
    EXPECT_EQ(smoothed(bank, run, {variant}).viterbi_mode, expected) << name_of(variant);
}

/// This test uses the filter's own noise scale at every step.
TEST(Viterbi, KeepsToTheFiltersNoiseScale) {
  Bank bank = example_bank(1, 1, 3, 1e-16);
  bank.transition = TransitionMatrix((Eigen::MatrixXd(3, 3) << 0.7, 0.2, 0.1, 0.1, 0.8, 0.1, 0.3, 0.1, 0.6).finished());
  bank.noise_adaptation = {0.7, 1.0};
  const FilterOptions options{.noise = FilterNoise::adaptive};
  int differing = 0;
  for (const std::uint64_t seed : {30, 31, 32, 33, 34}) {
    Bank rough = bank;
    for (Mode& mode : rough.modes) mode.Q *= 16.0;
    const Trajectory run = simulate_bank(rough, 7, seed);
    BankFilter filter(bank, options);
    Eigen::VectorXd scale(7);  // scale of the step to each sample
    for (Index k = 0; k < 7; ++k) {
      scale(k) = k > 0 ? filter.snapshot().noise_scale : 1.0;
      filter.step(run.time_s(k), run.input.col(k), run.state.col(k));
    }
    const Eigen::VectorXi found = smoothed(bank, run, options).viterbi_mode;
    EXPECT_EQ(found, best_sequence(bank, run, scale)) << seed;
    differing += found != best_sequence(bank, run, Eigen::VectorXd::Ones(7));
  }
  EXPECT_GT(differing, 0) << "the scale decides nothing here";
}

TEST(Horizon, OneSampleAheadIsWhatTheFilterSays) {
  const Bank modes = example_bank(2, 1, 3);
  Trajectory run = simulate_bank(modes, 60, 26);
  run.state.col(30).setConstant(std::nan(""));
  for (const FilterVariant variant : {FilterVariant::imm, FilterVariant::kf}) {
    const Bank bank = test::steppable(modes, variant);
    const RunEvaluation e = evaluate_run(bank, run, {variant});
    const HorizonEvaluation h = evaluate_horizons(bank, run, {variant}, {4, 1});
    EXPECT_EQ(h.horizons, (std::vector<Index>{1, 4}));
    EXPECT_TRUE(near(h.error[0], e.innovation, 1e-14));
    EXPECT_TRUE(near(h.log_density.row(0), e.log_density.transpose(), 1e-12));
    EXPECT_TRUE(near(h.pit[0].row(0), e.pit.row(0), 1e-12));
    EXPECT_TRUE(std::isnan(h.log_density(1, 3)) && !std::isnan(h.log_density(1, 4)));
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

TEST(Horizon, SummarisesRunsAndPools) {
  const Bank bank = example_bank(1, 1, 2);
  std::vector<Trajectory> runs{simulate_bank(bank, 30, 28), simulate_bank(bank, 50, 29)};
  runs[1].run = "other";
  std::vector<std::vector<HorizonSums>> sums;
  for (const Trajectory& run : runs) sums.push_back(sum_horizons(evaluate_horizons(bank, run, {}, {1, 10})));
  const std::vector<HorizonRow> rows = summarize_horizons("bank", runs, sums);
  ASSERT_EQ(rows.size(), 6u);
  EXPECT_EQ(rows[5].run, "*");
  EXPECT_EQ(rows[5].horizon, 10);
  EXPECT_EQ(rows[5].samples, 20 + 40);
  EXPECT_NEAR(rows[5].log_score, (rows[1].log_score * 20 + rows[3].log_score * 40) / 60, 1e-12);
  EXPECT_GT(rows[5].rmse(0), rows[4].rmse(0));
  EXPECT_NEAR(rows[5].coverage_95, (rows[1].coverage_95 * 20 + rows[3].coverage_95 * 40) / 60, 1e-12);
}

}  // namespace
}  // namespace modebank
