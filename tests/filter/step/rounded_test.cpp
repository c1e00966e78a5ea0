// Filters of rounded measurements: R of at least q^2 / 12, and scores by masses (ModeSignal).
#include <gtest/gtest.h>

#include <cmath>

#include "filter/judge/evaluate.hpp"
#include "filter/judge/statistics.hpp"
#include "filter/step/bank_filter.hpp"
#include "modebank/judge/evaluate.hpp"
#include "tests/filter/drifting_test_support.hpp"
#include "tests/filter/filter_test_support.hpp"
#include "tests/support/golden.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using nlohmann::json;

Trajectory rounded(Trajectory run, double quantum) {
  for (double& value : run.state.reshaped()) value = std::round(value / quantum) * quantum;
  return run;
}

Bank with_quantum(Bank bank, double quantum) {
  bank.quantum.setConstant(bank.C.rows(), quantum);
  return bank;
}

Bank golden_bank(const json& source) {
  const json& of = source.at("bank");
  const VectorXd R = test::golden_rows(source.at("R"));
  const Index n = R.size();
  Bank bank;
  bank.structure = {n, 1, true};
  for (std::size_t j = 0; j < of.at("A").size(); ++j) {
    bank.modes.push_back({});
    bank.modes[j].model = {test::golden_rows(of.at("A")[j]), test::golden_rows(of.at("B")[j]),
                           test::golden_rows(of.at("c")[j])};
    bank.modes[j].Q = test::golden_rows(of.at("Q")[j]);
  }
  bank.C = Eigen::MatrixXd::Identity(n, n);
  bank.R = R.asDiagonal();
  bank.transition = TransitionMatrix(test::golden_rows(of.at("T")));
  bank.initial_probability = test::golden_rows(of.at("pi"));
  bank.quantum = test::golden_rows(source.at("quantum"));
  return bank;
}

TEST(Rounded, FilterAgreesWithTheIndependentReference) {
  const json golden = test::read_golden("imm_rounded");
  for (const json& source : golden.at("cases")) {
    SCOPED_TRACE(source.at("quantum").dump() + source.at("R").dump());
    Trajectory run;
    run.input = test::golden_rows(source.at("input")).transpose();
    run.state = test::golden_columns(source.at("measurement"));
    const RunEvaluation actual = evaluate_run(golden_bank(source), run, {});
    const json& expected = source.at("expected");
    const auto columns = [&](const char* name) { return test::golden_columns(expected.at(name)); };
    EXPECT_TRUE(test::near(actual.log_density.transpose(), columns("log_density"), 1e-10));
    EXPECT_TRUE(test::near(actual.state, columns("state"), 1e-10));
    EXPECT_TRUE(test::near(actual.covariance, columns("covariance"), 1e-10));
    EXPECT_TRUE(test::near(actual.mode_probability, columns("mu"), 1e-10));
    EXPECT_TRUE(test::near(actual.pit - 0.5 * actual.pit_width, columns("low"), 1e-10));
    EXPECT_TRUE(test::near(actual.pit + 0.5 * actual.pit_width, columns("high"), 1e-10));
  }
}

/// Only the scores tell a quantum from the R that it asks for.
TEST(Rounded, FilterIsThatOfTheLargerR) {
  const double quantum = 0.2;
  for (const Index n : {1, 2, 5}) {
    Bank bank = with_quantum(test::example_bank(n, 2, 3, 0.0), quantum), with_R = bank;
    with_R.quantum = {};
    with_R.R.diagonal().setConstant(quantum * quantum / 12.0);
    Trajectory run = rounded(test::simulate_bank(bank, 80, 3), quantum);
    run.state(0, 30) = std::nan("");
    const RunEvaluation a = evaluate_run(bank, run, {}), b = evaluate_run(with_R, run, {});
    EXPECT_EQ(a.state, b.state);
    EXPECT_EQ(a.covariance, b.covariance);
    EXPECT_EQ(a.mode_probability, b.mode_probability);
    EXPECT_TRUE(test::near(a.nis.tail(79), b.nis.tail(79), 0.0));
    EXPECT_EQ(log_likelihood(bank, run, {}), log_likelihood(with_R, run, {}));
    bank.R.diagonal().setConstant(1e-3);  // still less than the rounding
    EXPECT_EQ(evaluate_run(bank, run, {}).state, b.state);
  }
}

/// The probabilities of all values that a sample can have.
TEST(Rounded, MassesOfAllValuesSumToOne) {
  const double quantum = 0.02;
  const Bank bank = with_quantum(test::example_bank(1, 1, 2), quantum);
  const Trajectory run = rounded(test::simulate_bank(bank, 30, 2), quantum);
  Bank drifting = one_mode_bank(bank.structure, bank.theta(0), VectorXd::Constant(1, 1e-3));
  drifting.drift = {{1e-3, 1e-2, 0.97}, VectorXd::Ones(3)};
  drifting.running_noise = {0.9, 5.0, 1e-3 * drifting.noise_variance()};
  drifting.quantum = bank.quantum;
  const Index last = run.samples() - 1;
  for (const Bank& one : {bank, drifting}) {
    BankFilter filter(one, {});
    for (Index k = 0; k < last; ++k) filter.step(run.time_s(k), run.input.col(k), run.state.col(k));
    const std::vector<double> before = filter.snapshot();
    double sum = 0.0;
    for (Index i = -400; i <= 400; ++i) {
      filter.restore(before);
      const VectorXd y = run.state.col(last).array() + static_cast<double>(i) * quantum;
      sum += quantum * std::exp(filter.step(run.time_s(last), run.input.col(last), y).log_density);
    }
    EXPECT_NEAR(sum, 1.0, one.drift.empty() ? 1e-10 : 1e-4);  // heavy tails
  }
}

/// The transform that programs get, sample by sample and for a whole run. The quantum is a standard deviation.
TEST(Rounded, TransformOfTheInstalledFilterIsUniform) {
  const Index samples = 20000;
  const double quantum = 0.1;
  Bank bank = test::single_mode(test::example_bank(1, 1, 1, 0.0), 0);
  bank.modes[0].Q(0, 0) = 1e-2;
  const Trajectory run = rounded(test::simulate_bank(bank, samples, 6), quantum);
  const filter::Bank installed(std::make_shared<const Bank>(with_quantum(bank, quantum)));
  filter::BankFilter live(installed);
  RecordedRun recorded{"", false, {run.time_s.begin(), run.time_s.end()}, to_matrix(run.state), to_matrix(run.input)};
  const Matrix of_run = judge::evaluate_run(installed, recorded).pit;
  std::vector<double> pit;
  for (Index k = 0; k < samples; ++k) {
    const filter::Estimate& said = live.step(run.time_s(k), VectorXd(run.input.col(k)), VectorXd(run.state.col(k)));
    if (k == 0) continue;
    pit.push_back(said.pit[0]);
    ASSERT_EQ(said.pit[0], of_run.values[k]) << k;
  }
  constexpr double one_per_mille = 1.95;  // Kolmogorov's distribution
  EXPECT_LT(kolmogorov_distance(pit), one_per_mille / std::sqrt(static_cast<double>(samples)));
}

TEST(Rounded, DrawsDependOnSeedRunAndSampleAlone) {
  const Bank bank = with_quantum(test::example_bank(1, 1, 2), 0.05);
  Trajectory run = rounded(test::simulate_bank(bank, 50, 6), 0.05);
  const auto drawn = [&](std::uint64_t seed, const char* name) {
    RunEvaluation evaluation = evaluate_run(bank, run, {});
    run.run = name;
    draw_pit(run, seed, evaluation);
    return Eigen::MatrixXd(evaluation.pit.rightCols(49));
  };
  EXPECT_EQ(drawn(1, "a"), drawn(1, "a"));
  EXPECT_NE(drawn(1, "a"), drawn(2, "a"));
  EXPECT_NE(drawn(1, "a"), drawn(1, "b"));
}

}  // namespace
}  // namespace modebank
