// Compares the exported C code with the filter. Banks and runs reach every part of the C code.
#include <gmock/gmock.h>

#include "app/export/forms.hpp"
#include "modebank/base/error.hpp"
#include "tests/app/export/exported.hpp"
#include "tests/filter/filter_test_support.hpp"

namespace modebank::app::test {
namespace {

using modebank::test::example_bank;
using ::testing::HasSubstr;

constexpr Index samples = 400;
constexpr double dt_s = 0.1;

/// A run that fits any bank. Its values do not matter, because both filters get the same run.
Trajectory run_for(const Bank& bank, std::uint64_t seed) {
  Bank source = example_bank(bank.C.rows(), bank.structure.inputs, 2, 1e-3);
  return disturbed(modebank::test::simulate_bank(source, samples, seed), dt_s);
}

void expect_same(const Bank& bank, const FilterOptions& options) {
  const Differences worst = differences_of_c(as_exported(bank, options), {run_for(bank, 1), run_for(bank, 2)});
  EXPECT_LE(worst.mean, 1e-9);
  EXPECT_LE(worst.probability, 1e-9);
  EXPECT_LE(worst.covariance, 1e-9);
  EXPECT_LE(worst.log_density, 1e-9);
  EXPECT_LE(worst.ahead, 1e-9);
  EXPECT_GT(worst.compared, 2 * samples - 40);
}

Bank with_clock(Bank bank) {
  bank.dt_s = dt_s;
  bank.quantum = {};
  return bank;
}

/// A bank with two states (z and v), three lags of the states and two lags of the inputs.
Bank lagged_bank(const InputDelays& input_delay) {
  Bank bank = example_bank(2, 2, 2, 1e-4);
  bank.structure = {2, 2, true, 3, 2, input_delay};
  const Index p = bank.structure.parameters(), n = bank.structure.dimension();
  for (std::size_t j = 0; j < bank.modes.size(); ++j) {
    Mode& mode = bank.modes[j];
    const Eigen::MatrixXd Q = mode.Q;
    const Eigen::VectorXd theta = Eigen::VectorXd::LinSpaced(p, -0.2, 0.15 - 0.1 * static_cast<double>(j));
    mode.model = unpack(bank.structure, theta);
    mode.Q = Eigen::MatrixXd::Zero(n, n);
    mode.Q.topLeftCorner(2, 2) = Q;
    mode.parameter_covariance.resize(0, 0);
  }
  bank.C = Eigen::MatrixXd::Identity(2, n);
  return bank;
}

TEST(ExportedC, IsTheImm) {
  expect_same(with_clock(example_bank(1, 2, 3)), {});
  expect_same(with_clock(example_bank(2, 2, 4)), {});
  expect_same(with_clock(example_bank(2, 2, 3, 0.0)), {});
}

TEST(ExportedC, HasLags) {
  for (const InputDelays& delay : {InputDelays(0), InputDelays(1), InputDelays(2), InputDelays({4, 1})})
    expect_same(with_clock(lagged_bank(delay)), {});
}

TEST(ExportedC, SwitchesByStateAndInput) {
  Bank bank = example_bank(2, 1, 3);
  bank.transition_logit.weights.resize(3, 3);
  bank.transition_logit.weights << 0.0, 0.0, 0.0, 2.0, -1.0, 3.0, -300.0, 1.0, 0.5;
  bank.transition_logit.reference = Eigen::Vector3d(0.1, -0.05, 0.2);
  expect_same(with_clock(bank), {});
}

TEST(ExportedC, HasOneModeOrOnesThatNeverChange) {
  FilterOptions kf;
  kf.variant = FilterVariant::kf;
  expect_same(with_clock(example_bank(2, 2, 1)), kf);
  Bank constant = example_bank(2, 2, 3);
  constant.transition = TransitionMatrix::sticky(3, 1.0);
  expect_same(with_clock(constant), {});
}

TEST(ExportedC, NeedsNeitherInputsNorAllStatesNorAClock) {
  expect_same(with_clock(example_bank(2, 0, 2)), {});
  Bank partly = example_bank(3, 2, 2);
  partly.C = Eigen::MatrixXd(2, 3);
  partly.C << 1.0, 0.0, 0.5, 0.0, 1.0, -0.3;
  partly.R = Eigen::Matrix2d{{2e-4, 5e-5}, {5e-5, 1e-4}};
  expect_same(with_clock(partly), {});
  expect_same(example_bank(1, 1, 2), {});
}

TEST(ExportedC, KeepsModesThatTheMatrixForbids) {
  Bank bank = example_bank(1, 1, 3);
  bank.transition = TransitionMatrix(Eigen::Matrix3d{{0.9, 0.1, 0.0}, {0.2, 0.8, 0.0}, {0.5, 0.5, 0.0}});
  expect_same(with_clock(bank), {});
}

TEST(ExportedC, RefusesByNameWhatItDoesNotHave) {
  const auto refusal = [](const Bank& bank, const FilterOptions& options) -> std::string {
    try {
      to_c(as_exported(bank, options), "robot");
    } catch (const DataError& error) {
      return error.what();
    }
    return "";
  };
  FilterOptions options;
  options.variant = FilterVariant::salvi2025;
  EXPECT_THAT(refusal(example_bank(1, 1, 2), options), HasSubstr("filter.variant = salvi2025"));
  Bank coarse = example_bank(1, 1, 2);
  coarse.quantum = Eigen::VectorXd::Constant(1, 0.01);
  EXPECT_THAT(refusal(coarse, {}), HasSubstr("data.quantum"));
  Bank bent = example_bank(1, 1, 2);
  bent.terms.terms = {{TermKind::magnitude, {0}}};
  EXPECT_THAT(refusal(bent, {}), HasSubstr("window.terms"));
}

}  // namespace
}  // namespace modebank::app::test
