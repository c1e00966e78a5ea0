// Free runs of several modes: moments and sample paths, compared with the sum over all sequences of modes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "filter/judge/free_run.hpp"
#include "filter/judge/sample_paths.hpp"
#include "tests/filter/filter_test_support.hpp"
#include "tests/filter/free_run_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using Eigen::Index;
using test::after;
using test::any_run;
using test::arx_bank;
using test::example_bank;
using test::near;
using test::simulate_bank;
using test::stable_theta;
using test::with_paths;
using ::testing::HasSubstr;

/// Two modes of one state that differ in everything; T is not symmetric.
Bank two_modes() {
  Bank bank = example_bank(1, 1, 2, 1e-3);
  bank.modes[1].model.A(0, 0) = 0.1;
  bank.modes[1].model.c(0) = 0.3;
  bank.modes[1].Q(0, 0) = 0.01;
  bank.transition = TransitionMatrix((Eigen::Matrix2d() << 0.8, 0.2, 0.4, 0.6).finished());
  bank.initial_probability << 0.7, 0.3;
  return bank;
}

/// Every sequence of modes: its probability, and the Gaussian of x `steps` after x[0] ~ N(y, R).
struct Sequences {
  std::vector<double> probability, mean, variance;

  Sequences(const Bank& bank, const Trajectory& run, Index steps) {
    extend(bank, run, steps, 0, -1, 1.0, run.state(0, 0), bank.R(0, 0));
  }
  double average() const {
    double sum = 0.0;
    for (std::size_t s = 0; s < mean.size(); ++s) sum += probability[s] * mean[s];
    return sum;
  }
  double deviation(double R) const {
    double sum = R;
    for (std::size_t s = 0; s < mean.size(); ++s)
      sum += probability[s] * (variance[s] + (mean[s] - average()) * (mean[s] - average()));
    return std::sqrt(sum);
  }
  double below(double y, double R) const {
    double sum = 0.0;
    for (std::size_t s = 0; s < mean.size(); ++s)
      sum += probability[s] * 0.5 * std::erfc((mean[s] - y) / std::sqrt(2.0 * (variance[s] + R)));
    return sum;
  }

 private:
  void extend(const Bank& bank, const Trajectory& run, Index steps, Index k, Index mode, double p, double m, double P) {
    if (k == steps) {
      probability.push_back(p);
      mean.push_back(m);
      variance.push_back(P);
      return;
    }
    const Eigen::RowVectorXd row =
        mode < 0 ? Eigen::RowVectorXd(bank.initial_probability.transpose() * bank.transition.matrix())
                 : Eigen::RowVectorXd(bank.transition.matrix().row(mode));
    for (Index j = 0; j < row.size(); ++j) {
      const Mode& next = bank.modes[static_cast<std::size_t>(j)];
      const double F = 1.0 + next.model.A(0, 0);
      extend(bank, run, steps, k + 1, j, p * row(j), F * m + next.model.B(0, 0) * run.input(0, k) + next.model.c(0),
             F * F * P + next.Q(0, 0));
    }
  }
};

TEST(FreeRun, MomentsAreThoseOfAllSequencesOfModes) {
  const Bank bank = two_modes();
  const Trajectory run = simulate_bank(bank, 9, 3);
  const FreeRun found = free_run(bank, run, {}, after(1));
  for (Index k = 1; k < run.samples(); ++k) {
    const Sequences exact(bank, run, k);
    EXPECT_NEAR(found.mean(0, k), exact.average(), 1e-9) << k;
    EXPECT_NEAR(found.deviation(0, k), exact.deviation(bank.R(0, 0)), 1e-9) << k;
  }
  // After one step the distribution of each mode is Gaussian, so band and density are exact, too.
  const Sequences exact(bank, run, 1);
  EXPECT_NEAR(exact.below(found.lower(0, 1), bank.R(0, 0)), 0.025, 1e-9);
  EXPECT_NEAR(exact.below(found.upper(0, 1), bank.R(0, 0)), 0.975, 1e-9);
  EXPECT_NEAR(found.pit(0, 1), exact.below(run.state(0, 1), bank.R(0, 0)), 1e-9);
}

TEST(FreeRun, SamplePathsAreDrawnFromAllSequencesOfModes) {
  const Bank bank = two_modes();
  const Trajectory run = simulate_bank(bank, 9, 3);
  constexpr Index paths = 20000;
  const FreeRun found = free_run(with_paths(bank), run, {}, after(1, paths));
  const double R = bank.R(0, 0), of_band = 5.0 * std::sqrt(0.025 / static_cast<double>(paths));
  for (Index k = 1; k < run.samples(); ++k) {
    const Sequences exact(bank, run, k);
    const double sd = exact.deviation(R);
    EXPECT_NEAR(found.mean(0, k), exact.average(), 5.0 * sd / std::sqrt(static_cast<double>(paths))) << k;
    EXPECT_NEAR(found.deviation(0, k), sd, 0.04 * sd) << k;
    EXPECT_NEAR(exact.below(found.lower(0, k), R), 0.025, of_band) << k;
    EXPECT_NEAR(exact.below(found.upper(0, k), R), 0.975, of_band) << k;
    EXPECT_NEAR(found.pit(0, k), exact.below(run.state(0, k), R), 5.0 * 0.5 / std::sqrt(static_cast<double>(paths)));
  }
  EXPECT_EQ(found.lost_paths, 0);
}

TEST(FreeRun, MomentsAndPathsAgreeWithLagsAndSeveralStates) {
  LinearStructure s{2, 1, true, 2, 2, 1};
  Bank bank = arx_bank(s, stable_theta(s));
  bank.modes.push_back(bank.modes[0]);
  bank.modes[1].model.B *= -1.0;
  for (Mode& mode : bank.modes) mode.Q *= 0.01;
  bank.R = 1e-3 * Eigen::Matrix2d::Identity();
  bank.transition = TransitionMatrix::sticky(2, 0.8);
  bank.initial_probability = Eigen::Vector2d::Constant(0.5);
  const Trajectory run = any_run(s, 60);
  const FreeRun exact = free_run(bank, run, {}, after(20)),
                drawn = free_run(with_paths(bank), run, {}, after(20, 10000));
  const Eigen::ArrayXXd sd = exact.deviation.rightCols(40);
  EXPECT_LT(((drawn.mean - exact.mean).rightCols(40).array() / sd).abs().maxCoeff(), 0.06);
  EXPECT_LT((drawn.deviation.rightCols(40).array() / sd - 1.0).abs().maxCoeff(), 0.05);
  EXPECT_LT((drawn.log_density - exact.log_density).tail(40).cwiseAbs().mean(), 0.1);
}

TEST(FreeRun, EqualSeedsAreEqualPaths) {
  const Bank bank = with_paths(two_modes());
  const Trajectory run = simulate_bank(bank, 50, 5);
  FreeRunOptions options = after(3, 30);
  const FreeRun one = free_run(bank, run, {}, options), same = free_run(bank, run, {}, options);
  EXPECT_TRUE(near(one.mean, same.mean, 0.0) && near(one.upper, same.upper, 0.0));
  options.seed = 2;
  EXPECT_FALSE(near(one.mean, free_run(bank, run, {}, options).mean, 0.0));
}

TEST(FreeRun, SaysOfPathsThatLeaveTheFiniteRange) {
  Bank bank = two_modes();
  bank.modes[1].model.A(0, 0) = 1e4;
  bank.transition = TransitionMatrix((Eigen::Matrix2d() << 0.9, 0.1, 0.01, 0.99).finished());
  const Trajectory run = simulate_bank(two_modes(), 200, 6);
  const FreeRun found = free_run(with_paths(bank), run, {}, after(1, 50));
  EXPECT_EQ(found.lost_paths, 50);
  ASSERT_EQ(found.notes.size(), 1u);
  EXPECT_THAT(found.notes[0], HasSubstr("later predictions are not finite"));
  const Index predicted = (!found.mean.row(0).array().isNaN()).count();
  EXPECT_GT(predicted, 10);
  EXPECT_TRUE(found.mean.middleCols(1, predicted).allFinite());
}

/// State-dependent transitions: mode 1 if x is positive. Without noise, the path is that of the piecewise recursion.
TEST(SamplePaths, ModesMayFollowStateAndInput) {
  Bank bank = two_modes();
  for (Mode& mode : bank.modes) mode.Q.setZero();
  bank.modes[1].model.A(0, 0) = -0.8;
  bank.modes[1].model.c(0) = 0.1;
  bank.modes[0].model.c(0) = 0.1;
  const Trajectory run = simulate_bank(two_modes(), 40, 9);
  const auto ruling = [](double x, double u) { return x + u > 0.5 ? 1 : 0; };
  constexpr double steep = 1e6;
  bank.transition_logit = {steep * Eigen::Matrix2d{{0.0, 0.0}, {1.0, 1.0}}, Eigen::Vector2d(0.5, 0.0)};
  SamplePaths paths(bank, 5, 1);
  FilterState<Eigen::Dynamic> origin{{2, Gaussian<Eigen::Dynamic>(1)}, bank.initial_probability};
  for (Gaussian<Eigen::Dynamic>& mode : origin.modes) mode.mean(0) = 0.4;
  paths.start(origin);
  double x = 0.4;
  std::array<int, 2> visits{};
  for (Index k = 0; k < run.samples(); ++k) {
    const int mode = ruling(x, run.input(0, k));
    ++visits[static_cast<std::size_t>(mode)];
    x = bank.modes[static_cast<std::size_t>(mode)].model.next(Eigen::VectorXd::Constant(1, x), run.input.col(k))(0);
    paths.step(run.input.col(k));
    EXPECT_TRUE(near(paths.states(), Eigen::MatrixXd::Constant(1, 5, x), 1e-12)) << k;
    EXPECT_EQ(paths.modes(), std::vector<Index>(5, mode));
  }
  EXPECT_GT(visits[0], 3);
  EXPECT_GT(visits[1], 3);
}

}  // namespace
}  // namespace modebank
