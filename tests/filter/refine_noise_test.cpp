// R by the filter's likelihood, where that is exact: one mode.
#include "filter/refine_noise.hpp"

#include <gtest/gtest.h>

#include <boost/random/normal_distribution.hpp>
#include <cmath>
#include <random>

#include "filter/bank_frame.hpp"
#include "tests/filter/learn_test_support.hpp"

namespace modebank {
namespace {

constexpr double Q_true = 0.04;

/// y = x + v, x[k+1] = 0.8 x[k] + w.
Recording measured_with(double R) {
  std::mt19937_64 generator(23);
  boost::random::normal_distribution<double> normal;
  Recording recording = test::empty_recording(1, 0);
  for (int run = 0; run < 3; ++run) {
    Eigen::MatrixXd y(1, 800);
    double x = 0.0;
    for (Index k = 0; k < y.cols(); ++k) {
      y(k) = x + std::sqrt(R) * normal(generator);
      x = 0.8 * x + std::sqrt(Q_true) * normal(generator);
    }
    test::add_run(recording, y, Eigen::MatrixXd(0, y.cols()));
  }
  return recording;
}

Bank bank_with(const Recording& recording, double Q) {
  const LinearStructure structure = test::structure_of(recording);
  Bank bank = bank_frame(recording, structure, Eigen::MatrixXd::Constant(1, 1, 1e-9));
  bank.modes.push_back(
      make_mode(structure, Eigen::VectorXd::Constant(1, -0.2), Eigen::MatrixXd::Constant(1, 1, Q), {}, {}, 1.0));
  set_mode_sequence(bank, TransitionMatrix());
  return bank;
}

TEST(RefineNoise, SplitsQAndRWithinThreeStandardErrors) {
  const double R = 0.02;
  const Recording recording = measured_with(R);
  Bank bank = bank_with(recording, Q_true + 2.0 * R);
  estimate_measurement_noise(recording, {}, bank);
  ASSERT_EQ(bank.R_standard_error.rows(), 1);
  EXPECT_LT(std::abs(bank.R(0, 0) - R), 3.0 * bank.R_standard_error(0, 0));
  EXPECT_LT(bank.R_standard_error(0, 0), 0.25 * R);
  EXPECT_NEAR(bank.modes[0].Q(0, 0), Q_true, 0.2 * Q_true);
}

TEST(RefineNoise, KeepsRWhereTheDataShowNone) {
  const Recording recording = measured_with(0.0);
  Bank bank = bank_with(recording, Q_true);
  estimate_measurement_noise(recording, {}, bank);
  EXPECT_EQ(bank.R(0, 0), 1e-9);
  EXPECT_EQ(bank.modes[0].Q(0, 0), Q_true);
  EXPECT_EQ(bank.R_standard_error.size(), 0);
}

}  // namespace
}  // namespace modebank
