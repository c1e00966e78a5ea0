// One step must not allocate. A program of its own, with EIGEN_RUNTIME_NO_MALLOC defined for all its sources: the guard
// changes Eigen's inline functions. It reports through eigen_assert, redefined here so that release builds report too.
namespace {
int failed_assertions = 0;
}  // namespace
#define eigen_assert(condition)            \
  do {                                     \
    if (!(condition)) ++failed_assertions; \
  } while (false)

#include <gtest/gtest.h>

#include <cstdlib>
#include <new>

#include "filter/bank_filter.hpp"
#include "filter/combined.hpp"
#include "filter/filter_step.hpp"
#include "tests/filter/filter_test_support.hpp"

namespace {
bool new_is_counted = false;
int news = 0;
}  // namespace

// Eigen's guard sees only Eigen; this one sees std::vector as well.
[[gnu::noinline]] void* operator new(std::size_t size) {
  news += new_is_counted ? 1 : 0;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace modebank {
namespace {

class NoAllocationScope {
 public:
  NoAllocationScope() {
    news = failed_assertions = 0;
    new_is_counted = true;
    Eigen::internal::set_is_malloc_allowed(false);
  }
  ~NoAllocationScope() {
    new_is_counted = false;
    Eigen::internal::set_is_malloc_allowed(true);
  }
  NoAllocationScope(const NoAllocationScope&) = delete;
  NoAllocationScope& operator=(const NoAllocationScope&) = delete;
};

template <int N, int NY>
void step_without_allocation(const Bank& bank, const FilterOptions& options) {
  Trajectory run = test::simulate_bank(bank, 30, 1);
  const FilterModel<N, NY> model(bank, options);
  FilterStep<N, NY> step(model);
  FilterState<N> state = start(model, run.state.col(0));
  CombinedPrediction<N, NY> combined(bank.structure.states, bank.C.rows());
  Gaussian<N> estimate(bank.structure.states);
  Eigen::VectorXd pit(bank.C.rows()), weights(step.hypothesis_probability().size());
  const NoAllocationScope scope;
  for (Eigen::Index k = 1; k < run.samples(); ++k) {
    predict(model, state, run.input.col(k - 1), step);
    combined.expect(model, step);
    if (k % 7 == 0) {
      skip_measurement(step, state);
    } else {
      if (k % 5 == 0 && run.state.rows() > 1) run.state(0, k) = std::nan("");
      update(model, run.state.col(k), step, state);
      combined.observe(model.C, run.state.col(k));
      probability_transform(run.state.col(k), step, weights, pit);
    }
    merge(state.modes, state.mode_probability, estimate);
  }
  EXPECT_EQ(news, 0) << name_of(options.variant) << ", n = " << bank.structure.states;
  EXPECT_EQ(failed_assertions, 0) << name_of(options.variant) << ", n = " << bank.structure.states;
}

TEST(NoAllocation, GuardsSeeAllocations) {
  const NoAllocationScope scope;
  const Eigen::VectorXd by_eigen = Eigen::VectorXd::Ones(100);
  EXPECT_GE(failed_assertions, 1);
  const std::vector<double> by_new(static_cast<std::size_t>(by_eigen.size()), by_eigen(0));
  EXPECT_GE(news, 1) << by_new.size();
}

TEST(NoAllocation, TheBankFilter) {
  for (const FilterVariant variant : {FilterVariant::imm, FilterVariant::gpb2})
    for (const Eigen::Index n : {1, 3, 5}) {
      Bank bank = test::example_bank(n, 2, 3);
      bank.dt_s = 1.0;
      Trajectory run = test::simulate_bank(bank, 30, 1);
      run.time_s.tail(10).array() += 3.0;
      run.time_s.tail(5).array() += 2.0 * longest_gap_steps;
      run.state(0, 12) = std::nan("");
      BankFilter filter(bank, {variant});
      const NoAllocationScope scope;
      for (Eigen::Index k = 0; k < run.samples(); ++k) filter.step(run.time_s(k), run.input.col(k), run.state.col(k));
      EXPECT_EQ(news, 0) << name_of(variant) << ", n = " << n;
      EXPECT_EQ(failed_assertions, 0) << name_of(variant) << ", n = " << n;
    }
}

TEST(NoAllocation, EveryVariantAndSize) {
  for (const FilterVariant variant : {FilterVariant::imm, FilterVariant::mmae, FilterVariant::gpb1, FilterVariant::gpb2,
                                      FilterVariant::salvi2025, FilterVariant::kf})
    for (const bool parameter_noise : {false, true}) {
      const FilterOptions options{variant, parameter_noise};
      step_without_allocation<1, 1>(test::example_bank(1, 2, 3), options);
      step_without_allocation<2, 2>(test::example_bank(2, 2, 3), options);
      step_without_allocation<3, 3>(test::example_bank(3, 2, 3), options);
      step_without_allocation<-1, -1>(test::example_bank(5, 2, 3), options);
    }
}

}  // namespace
}  // namespace modebank
