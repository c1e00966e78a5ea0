// Standard errors of a bank from the gradients of single samples: effect of the filter.
#include "filter/learn/likelihood/standard_errors.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "filter/learn/switching/em.hpp"
#include "tests/filter/learn/refine_recovery.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using test::near;

class StandardErrors : public testing::Test {
 protected:
  Bank truth = test::true_scalar(1.0);
  Recording recording = test::simulated_recording(truth, 2, 500, 9);

  /// Standard errors of the true parameters for a given recording and filter. All other inputs come from the whole
  /// recording.
  Bank errors_in(const Recording& of, const FilterOptions& filter) const {
    const TrainingTransitions transitions = gather_training_transitions(recording, truth.structure);
    const SwitchingPrior prior = switching_prior(transitions, fit_global(recording, truth.structure), {}, 1.0);
    const SwitchingSums sums = sum_transitions(transitions, smooth_modes(transitions, switching_model(truth)), prior);
    const FreeParameters free = all_parameters(truth, sums, prior, false, true, Eigen::VectorXd::Zero(1));
    return with_standard_errors({of, filter, prior}, free, sums, truth);
  }

  static void expect_same(const Bank& a, const Bank& b, double tolerance) {
    for (std::size_t j = 0; j < 2; ++j) {
      EXPECT_TRUE(near(a.modes[j].parameter_covariance, b.modes[j].parameter_covariance, tolerance));
      EXPECT_TRUE(near(a.modes[j].Q_standard_error, b.modes[j].Q_standard_error, tolerance));
    }
    EXPECT_TRUE(near(a.R_standard_error, b.R_standard_error, tolerance));
    EXPECT_TRUE(near(a.transition_standard_error, b.transition_standard_error, tolerance));
  }
};

/// A filter that ignores times makes one step at every gap.
TEST_F(StandardErrors, AreThoseOfTheFilterThatRuns) {
  truth.dt_s = recording.median_period_s();
  const Bank plain = errors_in(recording, {});
  Recording gaps = recording;
  for (Trajectory& run : gaps.runs)
    for (Index k = 0; k < run.samples(); ++k)
      run.time_s(k) += 3.0 * truth.dt_s * std::floor(static_cast<double>(k) / 10.0);
  EXPECT_FALSE(errors_in(gaps, {}).modes[0].parameter_covariance.isApprox(plain.modes[0].parameter_covariance, 0.05));
}

/// A mode that occurs only in a later run. The samples before this run are more than the standard errors are computed
/// from. Closed form: least squares' Q (sum of phi phi')^-1 of that run.
TEST(StandardErrorsOfLongData, RestOnAllRuns) {
  const Bank truth = test::true_bank({1, 1, false}, Eigen::MatrixXd{{-0.2, -0.6}, {1.0, 3.0}},
                                     {Eigen::MatrixXd{{0.01}}, Eigen::MatrixXd{{0.04}}}, Eigen::VectorXd::Zero(1), 1.0);
  Recording recording = test::empty_recording(1, 1);
  for (const Index mode : {0, 1})
    recording.runs.push_back(
        test::simulated_recording(test::single_mode(truth, mode), 1, 30000, 5 + static_cast<std::uint64_t>(mode))
            .runs.front());
  const TrainingTransitions transitions = gather_training_transitions(recording, truth.structure);
  const SwitchingPrior prior = switching_prior(transitions, fit_global(recording, truth.structure), {}, 1.0);
  Bank sticky = truth;
  sticky.transition = TransitionMatrix::sticky(2, 0.999);
  const SwitchingSums sums = sum_transitions(transitions, smooth_modes(transitions, switching_model(sticky)), prior);
  const FreeParameters free = all_parameters(sticky, sums, prior, false, false, Eigen::VectorXd::Zero(1));
  const Bank bank = with_standard_errors({recording, {}, prior}, free, sums, sticky);
  for (const std::size_t mode : {0u, 1u}) {
    const Trajectory& run = recording.runs[mode];
    Eigen::MatrixXd phi(2, run.transitions());
    phi << run.state.leftCols(run.transitions()), run.input.leftCols(run.transitions());
    const Eigen::Matrix2d covariance = truth.modes[mode].Q(0, 0) * Eigen::Matrix2d(phi * phi.transpose()).inverse();
    for (const Index i : {0, 1})
      EXPECT_NEAR(bank.modes[mode].standard_error(i) / std::sqrt(covariance(i, i)), 1.0, 0.15) << mode << ' ' << i;
  }
}

/// Expectation-maximisation gives all runs equal weight, whether their noise is large or small. So its errors are those
/// of a filter with equal weights.
TEST(StandardErrorsByDraws, AreAsLargeAsTheErrorsWhereRunsDifferInRoughness) {
  constexpr std::uint64_t draws = 30;
  const Bank truth = test::true_bank({1, 1, false}, Eigen::Vector2d(-0.3, 0.5), {Eigen::MatrixXd{{0.01}}},
                                     Eigen::VectorXd::Zero(1), 1.0);
  RefineOptions options;
  options.folds = 3;
  options.measurement_noise = false;
  Eigen::Array2d squares = Eigen::Array2d::Zero();
  for (std::uint64_t draw = 0; draw < draws; ++draw) {
    Recording recording = test::empty_recording(1, 1);
    for (std::uint64_t run = 0; run < 6; ++run) {
      Bank rough = truth;
      rough.modes[0].Q *= run % 2 ? 0.16 : 4.0;
      recording.runs.push_back(test::simulated_recording(rough, 1, 200, 1000 + 10 * draw + run).runs.front());
    }
    const Bank bank = refine_bank(recording, test::windows_of(recording, 25, 1), {truth}, options, {}).bank;
    squares += ((bank.theta(0) - truth.theta(0)).array() / bank.modes[0].standard_error.array()).square();
  }
  const Eigen::Array2d rms = (squares / static_cast<double>(draws)).sqrt();
  EXPECT_GT(rms.minCoeff(), 0.7);
  EXPECT_LT(rms.maxCoeff(), 1.4);
}

}  // namespace
}  // namespace modebank
