// The filter in vector registers, and with sizes that the compiler knows, against the general one.
#include <gtest/gtest.h>

#include <cmath>

#include "filter/evaluate.hpp"
#include "filter/fixed_imm.hpp"
#include "filter/scalar_imm.hpp"
#include "tests/filter/filter_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using Eigen::Index;
using test::example_bank;
using test::simulate_bank;

/// Sum of what evaluate_run, which has no vector kernel, says of every sample.
double evaluated(const Bank& bank, const Trajectory& run) {
  double sum = 0.0;
  for (const double value : evaluate_run(bank, run, {}).log_density) sum += std::isnan(value) ? 0.0 : value;
  return sum;
}

Bank scalar_bank(Index modes) {
  Bank bank = example_bank(1, 2, modes);
  for (Index j = 0; j < modes; ++j) {
    Mode& mode = bank.modes[static_cast<std::size_t>(j)];
    mode.model.A.setConstant(-0.1 - 0.8 * static_cast<double>(j) / static_cast<double>(modes));  // stable ones
    mode.Q.setConstant(1e-4 * static_cast<double>(1 + j));
  }
  return bank;
}

TEST(ScalarImm, AgreesWithTheGeneralFilterForAnyNumberOfModes) {
  for (const Index modes : {2, 3, 7, 8, 9, 16, 17, 25, 60}) {
    const Bank bank = scalar_bank(modes);
    Trajectory run = simulate_bank(bank, 300, 31);
    run.state.middleCols(40, 3).setConstant(std::nan(""));
    run.state(0, 200) = 50.0;
    ASSERT_TRUE(scalar_imm::can_step(bank, {}) && scalar_imm::can_take(bank, run, {}));
    const double expected = evaluated(bank, run);
    EXPECT_NEAR(log_likelihood(bank, run, {}), expected, 1e-11 * std::abs(expected)) << modes << " modes";
  }
}

TEST(ScalarImm, TakesManyRunsAndBanksAtOnce) {
  std::vector<Bank> banks;
  std::vector<Trajectory> runs;
  for (Index i = 0; i < 19; ++i) {
    banks.push_back(scalar_bank(4));
    banks.back().modes[0].Q *= 1.0 + 0.1 * static_cast<double>(i);
    banks.back().transition = TransitionMatrix::sticky(4, 0.8 + 0.01 * static_cast<double>(i));
    runs.push_back(simulate_bank(banks.back(), 50 + 7 * i, 40 + static_cast<std::uint64_t>(i)));
  }
  banks[3].C(0, 0) = 2.0;
  runs[5].state(0, 0) = std::nan("");  // starts later: the general filter's
  runs[6].state(0, 20) = std::nan("");
  std::vector<const Bank*> bank_list;
  std::vector<const Trajectory*> run_list;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    bank_list.push_back(&banks[i]);
    run_list.push_back(&runs[i]);
  }
  const std::vector<double> values = log_likelihoods(bank_list, run_list, {});
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const double expected = evaluated(banks[i], runs[i]);
    EXPECT_NEAR(values[i], expected, 1e-11 * std::abs(expected)) << "run " << i;
  }
}

TEST(ScalarImm, ARunsNumberDependsNeitherOnItsCompanyNorOnWhetherTheBankIsShared) {
  // Modes that are far apart and one that nothing leads to: the ways beside the usual one as well.
  Bank apart = scalar_bank(5);
  apart.modes[2].model.c.setConstant(1e3);
  apart.transition = TransitionMatrix::sticky(5, 1.0 - 1e-9);
  Bank unreached = scalar_bank(9);
  Eigen::MatrixXd T = unreached.transition.matrix();
  T.col(4).setZero();
  unreached.transition = TransitionMatrix(T.array().colwise() / T.rowwise().sum().array());
  for (const Bank& bank : {scalar_bank(9), scalar_bank(6), apart, unreached}) {
    std::vector<Trajectory> runs;
    for (Index i = 0; i < 21; ++i) {  // more than fill two registers, over the length of a piece of samples
      runs.push_back(simulate_bank(scalar_bank(bank.mode_count()), 30 + 9 * i, 70 + static_cast<std::uint64_t>(i)));
      runs.back().state.middleCols(1, 3).setConstant(std::nan(""));  // all are as likely as at first
      runs.back().state(0, 8 + i) = std::nan("");
    }
    runs[4].state(0, 20) = 1e6;
    const std::vector<Bank> copies(runs.size(), bank);
    std::vector<const Bank*> shared(runs.size(), &bank), own;
    std::vector<const Trajectory*> run_list;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      own.push_back(&copies[i]);
      run_list.push_back(&runs[i]);
    }
    const std::vector<double> together = log_likelihoods(shared, run_list, {});
    EXPECT_EQ(log_likelihoods(own, run_list, {}), together);
    for (std::size_t i = 0; i < runs.size(); ++i) {
      EXPECT_EQ(log_likelihoods({&bank}, {&runs[i]}, {}).front(), together[i]) << "run " << i;
      const double expected = evaluated(bank, runs[i]);
      EXPECT_NEAR(together[i], expected, 1e-11 * std::abs(expected)) << "run " << i;
    }
  }
}

TEST(ScalarImm, NeverSaysNaN) {
  Bank dead = scalar_bank(3);
  dead.initial_probability << 1.0, 0.0, 0.0;
  dead.transition = TransitionMatrix((Eigen::MatrixXd(3, 3) << 0.9, 0.1, 0, 0.2, 0.8, 0, 0.5, 0.5, 0).finished());
  Bank exact = scalar_bank(3);
  exact.R.setConstant(1e-12);
  Bank unstable = scalar_bank(3);
  unstable.modes[1].model.A.setConstant(5.0);
  Bank none = scalar_bank(3);
  none.R.setZero();
  for (Mode& mode : none.modes) mode.Q.setZero();
  for (const Bank& bank : {dead, exact, unstable, none}) {
    Trajectory run = simulate_bank(scalar_bank(3), 400, 32);
    run.state(0, 50) = 1e4;
    run.state(0, 60) = -1e29;
    run.state.middleCols(100, 200).setConstant(std::nan(""));
    EXPECT_TRUE(std::isfinite(log_likelihood(bank, run, {})));
    EXPECT_TRUE(std::isfinite(log_likelihoods({&bank}, {&run}, {}).front()));
  }
  const Trajectory run = simulate_bank(dead, 100, 33);
  EXPECT_NEAR(log_likelihood(dead, run, {}), evaluated(dead, run), 1e-9);
}

TEST(ScalarImm, LeavesToTheGeneralFilterWhatItCannot) {
  const Bank bank = scalar_bank(3);
  EXPECT_FALSE(scalar_imm::can_step(bank, {FilterVariant::mmae}));
  EXPECT_FALSE(scalar_imm::can_step(bank, {FilterVariant::imm, true}));
  EXPECT_FALSE(scalar_imm::can_step(example_bank(2, 1, 3), {}));
  EXPECT_FALSE(scalar_imm::can_step(test::single_mode(bank, 0), {}));
  Bank clocked = bank;
  clocked.dt_s = 1.0;
  Trajectory run = simulate_bank(bank, 30, 34);
  EXPECT_TRUE(scalar_imm::can_take(clocked, run, {}));
  run.time_s.tail(10).array() += 2.0;
  EXPECT_FALSE(scalar_imm::can_take(clocked, run, {}));
  EXPECT_NEAR(log_likelihood(clocked, run, {}), evaluated(clocked, run), 1e-9);
}

template <int N, int M, int K>
std::vector<double> trace(const Bank& bank, const Trajectory& run, const FilterOptions& options) {
  Imm<N, M, K> filter(bank, options);
  filter.start(run.state.col(0));
  std::vector<double> numbers;
  for (Index k = 1; k < run.samples(); ++k) {
    numbers.push_back(filter.step(run.input.col(k - 1), run.state.col(k)));
    numbers.push_back(filter.nis());
    numbers.insert(numbers.end(), filter.state().begin(), filter.state().end());
    const auto probability = filter.mode_probability();
    numbers.insert(numbers.end(), probability.begin(), probability.end());
  }
  return numbers;
}

TEST(Imm, FixedAndDynamicSizesGiveTheSameNumbers) {
  const Bank one = example_bank(1, 2, 4), two = example_bank(2, 1, 3);
  const Trajectory run_one = simulate_bank(one, 60, 35), run_two = simulate_bank(two, 60, 36);
  constexpr int any = Eigen::Dynamic;
  for (const FilterVariant variant : {FilterVariant::imm, FilterVariant::gpb2}) {
    EXPECT_EQ((trace<1, 2, 4>(one, run_one, {variant})), (trace<any, any, any>(one, run_one, {variant})));
    EXPECT_EQ((trace<2, 1, 3>(two, run_two, {variant})), (trace<any, any, any>(two, run_two, {variant})));
  }
  // And those of evaluate_run.
  Imm<2, 1, 3> filter(two);
  const RunEvaluation expected = evaluate_run(two, run_two, {});
  filter.start(run_two.state.col(0));
  for (Index k = 1; k < run_two.samples(); ++k) {
    EXPECT_EQ(filter.step(run_two.input.col(k - 1), run_two.state.col(k)), expected.log_density(k));
    EXPECT_TRUE(test::near(filter.prediction(), expected.prediction.col(k), 0.0));
    EXPECT_TRUE(test::near(filter.covariance().reshaped(), expected.covariance.col(k), 0.0));
  }
  EXPECT_THROW((Imm<1, 2, 3>(one)), std::invalid_argument);
  EXPECT_THROW((Imm<2, 2, 4>(one)), std::invalid_argument);
}

}  // namespace
}  // namespace modebank
