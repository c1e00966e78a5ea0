// One step must not allocate.
#include <gtest/gtest.h>

#include <utility>

#include "filter/step/combined_filter.hpp"
#include "tests/filter/drifting_test_support.hpp"
#include "tests/filter/filter_test_support.hpp"
#include "tests/filter/free_run_test_support.hpp"
#include "tests/support/allocation_counter.hpp"

namespace modebank {
namespace {

template <class Filter>
void run_without_allocation(Filter filter, const Trajectory& run) {
  const long before = test::allocations;
  for (Eigen::Index k = 0; k < run.samples(); ++k) filter.step(run.time_s(k), run.input.col(k), run.state.col(k));
  EXPECT_EQ(test::allocations - before, 0) << "n = " << run.state.rows();
}

TEST(NoAllocation, TheCounterSeesEigenAndOperatorNew) {
  const long before = test::allocations;
  const Eigen::VectorXd by_eigen = Eigen::VectorXd::Ones(100);
  const long eigen = test::allocations;
  const std::vector<double> by_new(by_eigen.size(), by_eigen(0));
  EXPECT_GT(eigen, before);
  EXPECT_GT(test::allocations, eigen) << by_new.size();
}

/// Missing signals, a longer time between two samples and a gap after which the filter starts again.
TEST(NoAllocation, TheBankFilterOfAnyBank) {
  std::vector<Bank> banks{test::with_levels(test::example_drifting(2, 1, 1)),
                          test::with_levels(test::example_drifting(2, 1, 3))};
  for (const Eigen::Index n : {1, 2, 3, 5}) {
    const Bank bank = test::example_bank(n, 2, 3);
    Bank rounded = bank;
    rounded.quantum.setConstant(n, 0.02);
    if (n > 1) rounded.quantum(1) = 0.0;
    banks.insert(banks.end(), {bank, rounded, test::with_paths(bank)});
  }
  for (Bank& bank : banks) {
    bank.dt_s = 1.0;
    Trajectory run = test::any_run(bank.structure, 60);
    run.time_s.tail(20).array() += 3.0;
    run.time_s.tail(10).array() += 2.0 * longest_gap_steps;
    run.state(0, 20) = std::nan("");
    run.state.col(25).setConstant(std::nan(""));
    run_without_allocation(BankFilter(bank, {}), run);
    if (!bank.drift.empty() || !bank.transition_logit.empty()) continue;
    for (const FilterVariant variant : {FilterVariant::salvi2025, FilterVariant::kf})
      run_without_allocation(BankFilter(test::steppable(bank, variant), {variant}), run);
  }
}

TEST(NoAllocation, NorDoCombinedFilters) {
  const Bank model = test::example_drifting(2, 1, 3), bank = test::example_bank(2, 1, 3);
  Trajectory run = test::simulate_drifting(model, 60, 1);
  run.state(0, 20) = std::nan("");
  run.state.col(25).setConstant(std::nan(""));
  std::vector<BankFilter> both;
  both.emplace_back(bank, FilterOptions{});
  both.emplace_back(model, FilterOptions{});
  run_without_allocation(CombinedFilter(std::move(both), {0.5, 0.5}), run);
}

}  // namespace
}  // namespace modebank
