// Standard errors of a bank from the gradients of single samples: effect of the filter.
#include <gtest/gtest.h>

#include <Eigen/LU>

#include "filter/learn/likelihood/maximum_likelihood.hpp"
#include "tests/filter/learn/refine_recovery.hpp"

namespace modebank {
namespace {

/// Standard errors of the bank's parameters, and of R if it is not zero. Errors given the modes, and the prior, come
/// from `recording`, the observed information from `of`.
Bank with_errors(const Bank& bank, const Recording& recording, const Recording& of) {
  const TrainingTransitions transitions = gather_training_transitions(recording, bank.structure);
  const SwitchingPrior prior = switching_prior(transitions, fit_global(recording, bank.structure), {}, 1.0);
  const Bank complete =
      with_complete_errors(transitions, smooth_modes(transitions, switching_model(bank)), prior, bank);
  return with_standard_errors({of, {}, prior}, all_parameters(complete, bank.R(0, 0) > 0.0, Eigen::VectorXd::Zero(1)),
                              complete);
}

/// A filter that ignores times makes one step at every gap.
TEST(StandardErrors, AreThoseOfTheFilterThatRuns) {
  Bank truth = test::true_scalar(1.0);
  const Recording recording = test::simulated_recording(truth, 2, 500, 9);
  truth.dt_s = recording.median_period_s();
  Recording gaps = recording;
  for (Trajectory& run : gaps.runs)
    for (Index k = 0; k < run.samples(); ++k)
      run.time_s(k) += 3.0 * truth.dt_s * std::floor(static_cast<double>(k) / 10.0);
  const Eigen::MatrixXd plain = with_errors(truth, recording, recording).modes[0].parameter_covariance;
  EXPECT_FALSE(with_errors(truth, recording, gaps).modes[0].parameter_covariance.isApprox(plain, 0.05));
}

/// A mode that occurs only in a later run. The samples before this run are more than the standard errors are computed
/// from. Closed form: least squares' Q (sum of phi phi')^-1 of that run.
TEST(StandardErrorsOfLongData, RestOnAllRuns) {
  const Bank truth = test::true_bank({1, 1, false}, Eigen::MatrixXd{{-0.2, -0.6}, {1.0, 3.0}},
                                     {Eigen::MatrixXd{{0.01}}, Eigen::MatrixXd{{0.04}}}, Eigen::VectorXd::Zero(1), 1.0);
  Recording recording = test::empty_recording(1, 1);
  for (const std::size_t mode : {0u, 1u})
    recording.runs.push_back(test::simulated_recording(test::single_mode(truth, mode), 1, 30000, 5 + mode).runs[0]);
  Bank sticky = truth;
  sticky.transition = TransitionMatrix::sticky(2, 0.999);
  const Bank bank = with_errors(sticky, recording, recording);
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
  const RefineOptions options{.folds = 3, .measurement_noise = false};
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
