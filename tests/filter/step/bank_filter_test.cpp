// Transition matrices, and the live filter with unusual banks and unusual samples.
#include "filter/step/bank_filter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <stdexcept>

#include "tests/filter/filter_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

TEST(BankFilter, RefusesBanksWhoseNumbersAreNone) {
  const std::vector<std::function<void(Bank&)>> spoil = {
      [](Bank& b) { b.modes[1].model.A(0, 0) = std::nan(""); },
      [](Bank& b) { b.modes[0].Q(0, 0) = std::nan(""); },
      [](Bank& b) { b.modes[0].Q(1, 1) = -1.0; },
      [](Bank& b) { b.R(0, 0) = -1e-9; },
      [](Bank& b) { b.C(0, 0) = std::nan(""); },
      [](Bank& b) { b.initial_probability(0) = std::nan(""); },
      [](Bank& b) { b.initial_probability.setZero(); },
      [](Bank& b) { b.initial_probability *= 0.4; },
  };
  for (std::size_t i = 0; i < spoil.size(); ++i) {
    Bank bank = test::example_bank(2, 1, 3);
    EXPECT_NO_THROW(BankFilter(bank, {}));
    spoil[i](bank);
    EXPECT_THROW(BankFilter(bank, {}), std::invalid_argument) << i;
  }
}

TEST(BankFilter, RefusesSamplesOfOtherSizes) {
  BankFilter filter(test::example_bank(2, 1, 3), {});
  EXPECT_THROW(filter.step(0.0, VectorXd::Zero(2), VectorXd::Zero(2)), std::invalid_argument);
  EXPECT_THROW(filter.step(0.0, VectorXd::Zero(1), VectorXd::Zero(3)), std::invalid_argument);
  EXPECT_FALSE(filter.started());
}

TEST(BankFilter, AnInputThatIsNoNumberIsTheLastKnownOne) {
  const Bank bank = test::example_bank(2, 1, 3);
  const auto last = [&](double odd) {
    BankFilter filter(bank, {});
    for (int k = 0; k < 20; ++k) {
      const double u = k == 10 ? odd : (k == 9 ? 0.3 : 0.1 * k);
      filter.step(k, VectorXd::Constant(1, u), VectorXd::Constant(2, 0.01 * k));
    }
    return filter.estimate().state;
  };
  EXPECT_EQ(last(std::nan("")), last(0.3));
  EXPECT_EQ(last(INFINITY), last(0.3));
}

/// S becomes singular without measurement noise, if the process noise has rank one or zero.
TEST(BankFilter, VariancesAreNeverNegative) {
  for (const Index n : {2, 3})
    for (const double q : {0.0, 1e-4}) {
      Bank bank = test::example_bank(n, 1, 3);
      bank.R.setZero();
      for (Mode& mode : bank.modes) mode.Q.setConstant(q);
      BankFilter filter(bank, {});
      for (int k = 0; k < 500; ++k) {
        VectorXd y(n);
        for (Index i = 0; i < n; ++i) y(i) = 0.1 * std::sin(0.1 * k + static_cast<double>(i));
        if (k == 200) y.setConstant(1e6);
        const FilterEstimate& e = filter.step(k, VectorXd::Constant(1, std::cos(0.05 * k)), y);
        ASSERT_TRUE(e.state.allFinite() && e.covariance.allFinite());
        ASSERT_GE(e.covariance.diagonal().minCoeff(), 0.0) << "n = " << n << ", q = " << q << ", sample " << k;
      }
    }
}

constexpr double matrix_rounding = 1e-15;

TEST(TransitionMatrix, KeepsARowStochasticMatrix) {
  const Eigen::MatrixXd T = (Eigen::MatrixXd(2, 2) << 0.95, 0.05, 0.10, 0.90).finished();
  EXPECT_TRUE(test::near(TransitionMatrix(T).matrix(), T, matrix_rounding));
}

TEST(TransitionMatrix, NormalisesRowsWithinTheTolerance) {
  const Eigen::MatrixXd T = (Eigen::MatrixXd(2, 2) << 0.95 + 5e-10, 0.05, 0.10, 0.90).finished();
  EXPECT_NEAR(TransitionMatrix(T).matrix().row(0).sum(), 1.0, matrix_rounding);
}

TEST(TransitionMatrix, RejectsWhatIsNotRowStochastic) {
  EXPECT_THROW(TransitionMatrix(Eigen::MatrixXd::Constant(2, 3, 1.0 / 3.0)), std::invalid_argument);
  EXPECT_THROW(TransitionMatrix(Eigen::MatrixXd(0, 0)), std::invalid_argument);
  EXPECT_THROW(TransitionMatrix(Eigen::MatrixXd::Constant(2, 2, 0.5 + 1e-8)), std::invalid_argument);
  EXPECT_THROW(TransitionMatrix((Eigen::MatrixXd(2, 2) << 1.1, -0.1, 0.5, 0.5).finished()), std::invalid_argument);
  EXPECT_THROW(TransitionMatrix(Eigen::MatrixXd::Constant(1, 1, std::nan(""))), std::invalid_argument);
  // Columns sum to one, and rows do not. This happens if a caller passes mixing weights by mistake.
  EXPECT_THROW(TransitionMatrix((Eigen::MatrixXd(2, 2) << 0.9, 0.3, 0.1, 0.7).finished()), std::invalid_argument);
}

TEST(TransitionMatrix, StickySpreadsTheRestEqually) {
  const Eigen::MatrixXd expected =
      (Eigen::MatrixXd(3, 3) << 0.9, 0.05, 0.05, 0.05, 0.9, 0.05, 0.05, 0.05, 0.9).finished();
  EXPECT_TRUE(test::near(TransitionMatrix::sticky(3, 0.9).matrix(), expected, matrix_rounding));
  EXPECT_EQ(TransitionMatrix::sticky(1, 0.3).matrix()(0, 0), 1.0);
  EXPECT_THROW(TransitionMatrix::sticky(0, 0.9), std::invalid_argument);
  EXPECT_THROW(TransitionMatrix::sticky(2, 1.1), std::invalid_argument);
}

}  // namespace
}  // namespace modebank
