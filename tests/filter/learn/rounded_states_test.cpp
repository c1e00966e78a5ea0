// Learning from measurements that are rounded to multiples of a quantum.
#include <gtest/gtest.h>

#include "tests/filter/filter_test_support.hpp"
#include "tests/filter/learn/learn_test_support.hpp"

namespace modebank {
namespace {

constexpr double quantum = 0.2;  // two standard deviations of the innovation

Recording rounded_recording(double to) {
  Bank bank = test::single_mode(test::example_bank(1, 1, 1, 0.0), 0);
  bank.structure.intercept = false;
  bank.modes[0].model.A(0, 0) = -0.3;
  bank.modes[0].model.B(0, 0) = 0.5;
  bank.modes[0].Q(0, 0) = 1e-2;
  Recording recording = test::empty_recording(1, 1);
  for (std::uint64_t i = 0; i < 6; ++i) {
    const Trajectory run = test::simulate_bank(bank, 500, 70 + i);
    test::add_run(recording, ((run.state / to).array().round() * to).matrix(), run.input);
  }
  return recording;
}

/// Least squares take rounding for noise of what predicts.
TEST(RoundedStates, TheBaselineFindsWhatLeastSquaresMiss) {
  Recording recording = rounded_recording(quantum);
  const LinearStructure structure = test::structure_of(recording);
  const GlobalModel global = fit_global(recording, structure);
  const double error = std::sqrt(global.covariance(0, 0));
  EXPECT_GT(std::abs(global.theta(0) + 0.3), 3.0 * error);
  EXPECT_EQ(learn_baseline(recording, global, structure).bank.theta(0), global.theta) << "the quantum is not known";
  recording.quantum.setConstant(1, quantum);
  const Bank bank = learn_baseline(recording, global, structure).bank;
  EXPECT_LT(std::abs(bank.theta(0)(0) + 0.3), 3.0 * error);
  EXPECT_LT(std::abs(bank.theta(0)(1) - 0.5), 4.0 * std::sqrt(global.covariance(1, 1)));
  EXPECT_GE(bank.R(0, 0), quantum * quantum / 12.0);
  EXPECT_NEAR(bank.modes[0].Q(0, 0) + bank.R(0, 0) - quantum * quantum / 12.0, 1e-2, 1e-3);
  EXPECT_EQ(bank.quantum, recording.quantum);
}

TEST(RoundedStates, NoiseOnlyFindsWhatLeastSquaresMiss) {
  Recording recording = rounded_recording(quantum);
  const LinearStructure structure = test::structure_of(recording);
  const Eigen::MatrixXd R = Eigen::MatrixXd::Zero(1, 1);
  const double error = std::sqrt(fit_global(recording, structure).covariance(0, 0));
  EXPECT_GT(std::abs(learn_noise_only(recording, structure, R).theta(0)(0) + 0.3), 3.0 * error);
  recording.quantum.setConstant(1, quantum);
  const Bank bank = learn_noise_only(recording, structure, R);
  for (Index j = 0; j < 8; ++j) EXPECT_LT(std::abs(bank.theta(j)(0) + 0.3), 3.0 * error);
  EXPECT_EQ(bank.R(0, 0), quantum * quantum / 12.0);
}

/// Most values equal the previous value. Huber's regression would treat this as an exact law.
TEST(RoundedStates, NoiseOnlyIsNotFooledByRepeats) {
  Recording recording = rounded_recording(0.9);
  const LinearStructure structure = test::structure_of(recording);
  recording.quantum.setConstant(1, 0.9);
  const Bank bank = learn_noise_only(recording, structure, Eigen::MatrixXd::Zero(1, 1));
  EXPECT_LT(bank.theta(0)(0), -0.3 + 0.1);  // errors of rounding are not white here, so theta is far from the truth
  EXPECT_GT(bank.theta(0)(1), 0.1);
}

}  // namespace
}  // namespace modebank
