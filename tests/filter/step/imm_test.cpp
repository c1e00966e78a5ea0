// The IMM filter: tests/golden/generate/imm_reference.py, an independent textbook implementation in numpy; laws that
// every bank must obey, whatever its numbers; fixed sizes, which must give the bits of the same equations of dynamic
// size.
#include "filter/step/imm.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "filter/step/samples.hpp"
#include "modebank/base/error.hpp"
#include "modebank/judge/evaluate.hpp"
#include "tests/filter/filter_test_support.hpp"
#include "tests/support/golden.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using filter::BankDescription;
using nlohmann::json;
using test::example_bank;
using test::example_description;
using test::golden_columns;
using test::golden_rows;
using test::near;
using test::simulate_bank;
using test::simulate_description;
using test::single_mode;

/// Both implementations use double precision over 40 steps, with condition numbers below 1e3. Relative to the largest
/// number, if it exceeds one: the first covariances of the unobserved state are about ten.
constexpr double tolerance = 1e-10;

Matrix golden_matrix(const json& rows) { return to_matrix(golden_rows(rows)); }

filter::Bank read_bank(const json& source) {
  filter::BankDescription bank;
  bank.C = golden_matrix(source.at("C"));
  bank.R = golden_matrix(source.at("R"));
  bank.transition = golden_matrix(source.at("T"));
  bank.initial_probability = source.at("pi").get<std::vector<double>>();
  for (const json& mode : source.at("modes")) {
    const auto c = mode.at("c").get<std::vector<double>>();
    bank.modes.push_back(
        {golden_matrix(mode.at("A")), golden_matrix(mode.at("B")), c, golden_matrix(mode.at("Q")), {}, 1.0});
  }
  bank.inputs = bank.modes[0].B.cols;
  bank.intercept = true;
  return filter::Bank(bank);
}

TEST(GoldenFilter, AgreesWithTheIndependentReference) {
  for (const char* name : {"imm_scalar", "imm_vector", "imm_partial", "imm_missing", "imm_three", "salvi2025_scalar",
                           "salvi2025_vector", "salvi2025_three"}) {
    SCOPED_TRACE(name);
    const json golden = test::read_golden(name), &expected = golden.at("expected");
    const filter::Bank bank = read_bank(golden.at("bank"));
    RecordedRun run;
    run.state = to_matrix(golden_columns(golden.at("measurement")));
    run.input = to_matrix(golden_columns(golden.at("input")));
    for (std::ptrdiff_t k = 0; k < run.state.cols; ++k) run.time_s.push_back(static_cast<double>(k));
    FilterOptions options;
    options.variant = parse_name<FilterVariant>(golden.at("variant").get<std::string>()).value();
    const judge::Evaluation actual = judge::evaluate_run(bank, run, options);
    const auto agrees = [&](const char* part, const MatrixXd& value) {
      const MatrixXd reference = golden_columns(expected.at(part));
      double scale = 1.0;
      for (const double entry : reference.reshaped()) scale = std::fmax(scale, std::abs(entry));
      EXPECT_TRUE(near(value, reference, tolerance * scale)) << part;
    };
    agrees("prediction", view(actual.prediction));
    agrees("innovation", view(actual.innovation));
    agrees("innovation_covariance", view(actual.innovation_covariance));
    agrees("state", view(actual.state));
    agrees("covariance", view(actual.covariance));
    agrees("nis", view(actual.nis).transpose());
    agrees("pit", view(actual.pit));
    agrees("log_density", view(actual.log_density).transpose());
    const Trajectory internal = to_trajectory(run, run.state.rows, run.input.rows);
    agrees("predicted", evaluate_run(bank.internal(), internal, options).mode_probability_predicted);
    agrees("mu", view(actual.mode_probability));
  }
}

/// Tolerance for two computations of a number of order one in double precision.
constexpr double law_rounding = 1e-12;
constexpr FilterOptions kf{FilterVariant::kf};

TEST(Imm, IdenticalModesAreOneFilter) {
  for (const Index n : {1, 2, 4}) {
    Bank bank = example_bank(n, 2, 3);
    bank.modes[1] = bank.modes[2] = bank.modes[0];
    const Trajectory run = simulate_bank(bank, 60, 2);
    const RunEvaluation a = evaluate_run(bank, run, {}), b = evaluate_run(single_mode(bank, 0), run, kf);
    for (const auto part : {&RunEvaluation::prediction, &RunEvaluation::innovation_covariance, &RunEvaluation::state,
                            &RunEvaluation::covariance, &RunEvaluation::pit})
      EXPECT_TRUE(near(a.*part, b.*part, law_rounding));
    EXPECT_TRUE(near(a.log_density, b.log_density, law_rounding * 10));  // sizes up to about ten
  }
}

/// The modes are equal, so any choice between them would be arbitrary.
TEST(Kf, RefusesSeveralModes) {
  const Bank bank = example_bank(1, 2, 3);
  EXPECT_THROW(BankFilter(bank, kf), std::invalid_argument);
  EXPECT_NO_THROW(BankFilter(single_mode(bank, 2), kf));
}

TEST(Imm, ProbabilitiesSumToOne) {
  const Bank bank = example_bank(2, 1, 4);
  for (const FilterVariant variant : {FilterVariant::imm, FilterVariant::salvi2025}) {
    const RunEvaluation e = evaluate_run(bank, simulate_bank(bank, 200, 4), {variant});
    for (const MatrixXd& probability : {e.mode_probability, e.mode_probability_predicted})
      EXPECT_TRUE(near(probability.colwise().sum(), Eigen::RowVectorXd::Ones(200), law_rounding));
    EXPECT_GE(e.mode_probability.minCoeff(), 0.5e-12);  // no probability is below 1e-12 before they are normalised
  }
}

TEST(LogLikelihood, IsTheSumOfLogDensities) {
  for (const Index n : {1, 2, 3, 4})
    for (const FilterVariant variant : {FilterVariant::imm, FilterVariant::salvi2025}) {
      const filter::Bank bank(example_description(n, 1, 3));
      RecordedRun run = simulate_description(bank.description(), 50, 10).run;
      run.state(0, 20) = std::nan("");
      double sum = 0.0;
      for (const double value : judge::evaluate_run(bank, run, {variant}).log_density)
        sum += std::isnan(value) ? 0.0 : value;
      EXPECT_EQ(judge::log_likelihood(bank, run, {variant}), sum);
    }
}

TEST(EvaluateRun, RejectsWhatDoesNotFit) {
  const BankDescription bank = example_description(2, 1, 2);
  RecordedRun run = simulate_description(bank, 10, 11).run;
  BankDescription other_Q = bank, other_T = bank;
  other_Q.modes[1].Q = Matrix(1, 1);
  other_T.transition = to_matrix(TransitionMatrix::sticky(3, 0.9).matrix());
  for (const BankDescription& bad : {other_Q, other_T, example_description(2, 2, 2), example_description(1, 1, 2)})
    EXPECT_THROW(judge::evaluate_run(filter::Bank(bad), run), std::invalid_argument);
  run.input(0, 4) = std::nan("");
  EXPECT_THROW(judge::evaluate_run(filter::Bank(bank), run), DataError);
}

/// All results of a filter over a run, sample by sample.
template <int N, int NY>
std::vector<double> results(const Bank& bank, const Trajectory& run, const FilterOptions& options) {
  ImmFilter<N, NY> filter(bank, options);
  VectorXd mean, pit(bank.C.rows()), width(bank.C.rows());
  MatrixXd S, covariance;
  std::vector<double> numbers;
  const auto add = [&](const auto& values) {
    for (const double value : values.reshaped()) numbers.push_back(std::isnan(value) ? -1.0 : value);
  };
  const RunInstants moments(bank, run);
  for (Index t = 0; t < moments.count(); ++t) {
    const auto& [k, starts, start] = moments.instants[t];
    if (starts) {
      filter.start(start);
      continue;
    }
    filter.predict(moments.inputs.col(t));
    filter.combine(mean, S);
    add(mean);
    add(S);
    add(filter.predicted_probability());
    double log_density = filter.update(run.state.col(k));
    if (!std::isnan(log_density)) {
      filter.transform(run.state.col(k), pit, width, log_density);
      add(pit);
      add(width);
    }
    add(VectorXd::Constant(1, log_density));
    filter.merge(mean, covariance);
    add(mean);
    add(covariance);
    add(filter.mode_probability());
  }
  return numbers;
}

void expect_same_bits(const Bank& bank, const Trajectory& run, const FilterOptions& options = {}) {
  const std::vector<double> fixed = with_sizes(bank.structure.dimension(), bank.C.rows(),
                                               [&]<int N, int NY>() { return results<N, NY>(bank, run, options); });
  ASSERT_GT(fixed.size(), 500U);
  EXPECT_EQ(fixed, (results<Eigen::Dynamic, Eigen::Dynamic>(bank, run, options)));
}

/// The example's modes, slowed down so that many of them are stable. Their noises have the same order of magnitude.
Bank many_modes(Index n, Index K) {
  Bank bank = test::example_bank(n, 2, K);
  for (Index j = 0; j < K; ++j) {
    Mode& mode = bank.modes[j];
    const double share = static_cast<double>(j) / static_cast<double>(K);
    mode.model.A = -(0.1 + 0.8 * share) * MatrixXd::Identity(n, n) + MatrixXd::Constant(n, n, 0.03);
    mode.Q = 1e-4 * (1.0 + 3.0 * share) * (MatrixXd::Identity(n, n) + MatrixXd::Constant(n, n, 0.3));
  }
  return bank;
}

/// A quantum of about a standard deviation, a tiny quantum, and with three signals a continuous one among them.
TEST(FixedSizes, GiveTheBitsOfDynamicOnes) {
  for (const Index n : {1, 2, 3})
    for (const Index K : {1, 2, 8, 9, 25})
      for (const double quantum : {0.0, 3e-2, 1e-6})
        for (const FilterVariant variant : {FilterVariant::imm, FilterVariant::salvi2025, FilterVariant::kf}) {
          if (variant == FilterVariant::kf && K > 1) continue;
          Bank bank = many_modes(n, K);
          bank.quantum.setConstant(n, quantum);
          if (n == 3) bank.quantum(1) = 0.0;
          Trajectory run = test::simulate_bank(bank, 70, 51);
          if (quantum > 0.0)
            for (double& value : run.state.reshaped()) value = std::round(value / quantum) * quantum;
          run.state(0, 30) = std::nan("");  // first some signals are missing, later all signals
          run.state.col(40).setConstant(std::nan(""));
          run.state(0, 50) = std::nan("");  // an outlier in the available signals
          run.state(n - 1, 50) += n > 1 ? 0.5 : 0.0;
          run.state(n - 1, 60) += 3.0;  // a measurement far out in a tail
          run.state(0, 65) = 1e6;
          SCOPED_TRACE(testing::Message() << n << " states, " << K << " modes, quantum " << quantum);
          expect_same_bits(bank, run, {variant});
        }
}

/// With lags, the filter starts from several measurements of a signal.
TEST(FixedSizes, LaggedSamples) {
  for (const Index lags : {2, 3}) {
    Bank bank = test::example_bank(1, 1, 3);
    bank.structure.state_lags = lags;
    for (Mode& mode : bank.modes) {
      mode.model = unpack(bank.structure, VectorXd::Constant(bank.structure.parameters(), -0.1));
      mode.parameter_covariance.resize(0, 0);
      const double q = mode.Q(0, 0);
      mode.Q = MatrixXd::Zero(lags, lags);
      mode.Q(0, 0) = q;
    }
    bank.C = MatrixXd::Identity(1, lags);
    Trajectory run = test::simulate_bank(test::example_bank(1, 1, 3), 60, 11);
    run.state(0, 30) = std::nan("");
    expect_same_bits(bank, run);
  }
}

}  // namespace
}  // namespace modebank
