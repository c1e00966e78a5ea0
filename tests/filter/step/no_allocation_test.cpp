// One step must not allocate.
#include <gtest/gtest.h>

#include <vector>

#include "filter/step/bank_filter.hpp"
#include "filter/step/equations/filter_step.hpp"
#include "filter/step/equations/predicted_mixture.hpp"
#include "tests/filter/drifting_test_support.hpp"
#include "tests/filter/filter_test_support.hpp"
#include "tests/support/allocation_counter.hpp"

namespace modebank {
namespace {

Bank with_logit(Bank bank) {
  const Eigen::Index d = bank.structure.dimension() + bank.structure.acting_inputs();
  bank.transition_logit = {Eigen::MatrixXd::Random(bank.mode_count(), d), Eigen::VectorXd::Constant(d, 0.1)};
  return bank;
}

template <int N, int NY>
void step_without_allocation(const Bank& modes, const FilterOptions& options) {
  const Bank bank = test::steppable(modes, options.variant);
  Trajectory run = test::simulate_bank(bank, 30, 1);
  const FilterModel<N, NY> model(bank, options);
  FilterStep<N, NY> step(model);
  FilterState<N> state = start(model, run.state.col(0));
  CombinedInnovation combined(bank.C.rows());
  Eigen::VectorXd mean(bank.structure.states);
  Eigen::MatrixXd S(bank.C.rows(), bank.C.rows());
  Gaussian<N> estimate(bank.structure.states);
  Eigen::VectorXd pit(bank.C.rows()), weights(step.predicted_probability.size());
  const long before = test::allocations;
  for (Eigen::Index k = 1; k < run.samples(); ++k) {
    predict(model, state, run.input.col(k - 1), step);
    combine(model, step, mean, S);
    if (k % 7 == 0) {
      skip_measurement(step, state);
    } else {
      if (k % 5 == 0 && run.state.rows() > 1) run.state(0, k) = std::nan("");
      update(model, run.state.col(k), step, state);
      combined.observe(bank.C, mean, S, run.state.col(k));
      probability_transform(run.state.col(k), step, weights, pit);
    }
    merge(state.modes, state.mode_probability, estimate);
  }
  EXPECT_EQ(test::allocations - before, 0) << name_of(options.variant) << "n = " << bank.structure.states;
}

TEST(NoAllocation, TheCounterSeesEigenAndOperatorNew) {
  const long before = test::allocations;
  const Eigen::VectorXd by_eigen = Eigen::VectorXd::Ones(100);
  const long eigen = test::allocations;
  const std::vector<double> by_new(static_cast<std::size_t>(by_eigen.size()), by_eigen(0));
  EXPECT_GT(eigen, before);
  EXPECT_GT(test::allocations, eigen) << by_new.size();
}

TEST(NoAllocation, TheBankFilter) {
  for (const Eigen::Index n : {1, 3, 5}) {
    Bank bank = test::example_bank(n, 2, 3);
    bank.dt_s = 1.0;
    Trajectory run = test::simulate_bank(bank, 30, 1);
    run.time_s.tail(10).array() += 3.0;
    run.time_s.tail(5).array() += 2.0 * longest_gap_steps;
    run.state(0, 12) = std::nan("");
    BankFilter filter(bank, {});
    const long before = test::allocations;
    for (Eigen::Index k = 0; k < run.samples(); ++k) filter.step(run.time_s(k), run.input.col(k), run.state.col(k));
    EXPECT_EQ(test::allocations - before, 0) << "n = " << n;
  }
}

TEST(NoAllocation, TheBankFilterOfRoundedSignals) {
  for (const Eigen::Index n : {1, 3}) {
    Bank bank = test::example_bank(n, 2, 3);
    bank.quantum.setConstant(n, 0.02);
    if (n > 1) bank.quantum(1) = 0.0;
    Trajectory run = test::simulate_bank(bank, 30, 1);
    run.state(0, 12) = std::nan("");
    BankFilter filter(bank, {});
    const long before = test::allocations;
    for (Eigen::Index k = 0; k < run.samples(); ++k) filter.step(run.time_s(k), run.input.col(k), run.state.col(k));
    EXPECT_EQ(test::allocations - before, 0) << "n = " << n;
  }
}

TEST(NoAllocation, EveryVariantAndSize) {
  for (const FilterVariant variant : {FilterVariant::imm, FilterVariant::salvi2025, FilterVariant::kf}) {
    const FilterOptions options{variant};
    step_without_allocation<1, 1>(test::example_bank(1, 2, 3), options);
    step_without_allocation<2, 2>(test::example_bank(2, 2, 3), options);
    step_without_allocation<3, 3>(test::example_bank(3, 2, 3), options);
    step_without_allocation<-1, -1>(test::example_bank(5, 2, 3), options);
  }
}

/// The transition matrix of a logit is recomputed at every step.
TEST(NoAllocation, NorWithATransitionLogit) {
  const Bank bank = with_logit(test::example_bank(2, 2, 3));
  step_without_allocation<2, 2>(bank, {});
  step_without_allocation<-1, -1>(with_logit(test::example_bank(5, 2, 3)), {});
  const Trajectory run = test::simulate_bank(bank, 30, 1);
  BankFilter filter(bank, {});
  const long before = test::allocations;
  for (Eigen::Index k = 0; k < run.samples(); ++k) filter.step(run.time_s(k), run.input.col(k), run.state.col(k));
  EXPECT_EQ(test::allocations - before, 0);
}

TEST(NoAllocation, DriftingFilterStepsWithoutAny) {
  for (const Eigen::Index lags : {1, 3}) {
    const Bank model = test::with_levels(test::example_drifting(2, 1, lags));
    Trajectory run = test::simulate_drifting(model, 60, 1);
    run.state(0, 20) = std::nan("");
    run.state.col(25).setConstant(std::nan(""));
    BankFilter filter(model, {});
    const long before = test::allocations;
    for (Eigen::Index k = 0; k < run.samples(); ++k) filter.step(run.time_s(k), run.input.col(k), run.state.col(k));
    EXPECT_EQ(test::allocations - before, 0) << lags;
  }
}

}  // namespace
}  // namespace modebank
