// The gradient of the filter's likelihood, compared with differences of the likelihood.
#include "filter/step/likelihood_gradient.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "filter/judge/evaluate.hpp"
#include "filter/step/samples.hpp"
#include "tests/filter/filter_test_support.hpp"

namespace modebank {
namespace {

using Eigen::Index;

using Change = std::function<void(Bank&, double)>;

/// Tests every number of a bank separately. For T, two entries of a row change together, so that the sum of the row
/// stays one.
std::vector<std::pair<std::string, Change>> all_changes(const Bank& bank) {
  std::vector<std::pair<std::string, Change>> changes;
  const Index n = bank.structure.dimension(), m = bank.structure.acting_inputs(), K = bank.mode_count();
  for (std::size_t j = 0; j < bank.modes.size(); ++j) {
    const double Q_scale = bank.modes[j].Q(0, 0);
    for (Index a = 0; a < n; ++a) {
      for (Index b = 0; b < n; ++b)
        changes.emplace_back("A", [=](Bank& to, double h) { to.modes[j].model.A(a, b) += 0.1 * h; });
      for (Index i = 0; i < m; ++i)
        changes.emplace_back("B", [=](Bank& to, double h) { to.modes[j].model.B(a, i) += 0.1 * h; });
      changes.emplace_back("c", [=](Bank& to, double h) { to.modes[j].model.c(a) += 0.1 * h; });
      for (Index b = 0; b <= a; ++b)
        changes.emplace_back("Q", [=](Bank& to, double h) {
          to.modes[j].Q(a, b) += Q_scale * h;
          if (a != b) to.modes[j].Q(b, a) += Q_scale * h;
        });
    }
  }
  for (Index i = 0; i < K; ++i)
    for (Index j = 1; j < K; ++j)
      changes.emplace_back("T", [=](Bank& to, double h) {
        Eigen::MatrixXd T = to.transition.matrix();
        T(i, 0) -= 0.01 * h;
        T(i, j) += 0.01 * h;
        to.transition = TransitionMatrix(T);
      });
  const double R_scale = bank.R(0, 0);
  for (Index i = 0; i < bank.R.rows(); ++i)
    for (Index k = bank.is_quantised() ? i : 0; k <= i; ++k)
      changes.emplace_back("R", [=](Bank& to, double h) {
        to.R(i, k) += R_scale * h;
        if (i != k) to.R(k, i) += R_scale * h;
      });
  return changes;
}

void expect_gradient(const Bank& bank, const Trajectory& run, const FilterOptions& options) {
  ASSERT_TRUE(has_likelihood_gradient(bank, options));
  const BankGradient gradient = log_likelihood_gradient(bank, run, options);
  constexpr double step = 1e-5;
  for (const auto& [name, change] : all_changes(bank)) {
    Bank up = bank, down = bank;
    change(up, step);
    change(down, -step);
    const double expected = log_likelihood(up, run, options) - log_likelihood(down, run, options);
    EXPECT_NEAR(gradient.along(down, up), expected, 1e-9 + 2e-6 * std::abs(expected)) << name;
  }
}

Bank bank_of(Index n, Index K, double r) {
  Bank bank = test::example_bank(n, 2, K, r);
  bank.dt_s = 1.0;
  bank.transition = TransitionMatrix::sticky(K, 0.8);
  if (n > 1) bank.R(1, 0) = bank.R(0, 1) = 0.3 * r;
  return bank;
}

/// Missing signals and samples, a longer time between two samples, and a gap after which the filter starts again.
TEST(LikelihoodGradient, IsThatOfEverySizeAndOfRunsWithGaps) {
  struct Dims {
    Index n, K;
    double r = 1e-3;
  };
  for (const auto& [n, K, r] :
       {Dims{1, 1}, {1, 2}, {1, 4, 1e-5}, {2, 1}, {2, 3}, {2, 4, 1e-5}, {3, 2, 1e-5}, {3, 4}, {4, 1}, {4, 2}, {5, 3}}) {
    SCOPED_TRACE(testing::Message() << "n " << n << ", K " << K << ", R " << r);
    const Bank bank = bank_of(n, K, r);
    Trajectory run = test::simulate_bank(bank, 120, 7);
    run.state(0, 10) = std::nan("");
    run.state.middleCols(20, 2).setConstant(std::nan(""));
    run.time_s.tail(70).array() += 3.0;
    run.time_s.tail(50).array() += 2.0 * longest_gap_steps;
    expect_gradient(bank, run, {});
  }
}

TEST(LikelihoodGradient, SeesPartOfTheState) {
  Bank bank = bank_of(2, 3, 1e-3);
  bank.C = Eigen::MatrixXd{{1.0, 0.5}};
  bank.R = Eigen::MatrixXd{{1e-3}};
  expect_gradient(bank, test::simulate_bank(bank, 60, 4), {});
  bank.transition_logit = {Eigen::MatrixXd::Ones(3, 4), Eigen::VectorXd::Zero(4)};
  EXPECT_FALSE(has_likelihood_gradient(bank, {}));
}

}  // namespace
}  // namespace modebank
