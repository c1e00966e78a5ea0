// Filters of fixed sizes, compared with the same equations of dynamic size in all results.
#include <gtest/gtest.h>

#include <cmath>

#include "filter/step/imm_filter.hpp"
#include "tests/filter/filter_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int any = Eigen::Dynamic;

/// Steps both filters through the run and compares all results, relative to the size of each number.
template <int N, int NY>
void expect_agreement(const Bank& bank, const Trajectory& run, const FilterOptions& options, double relative) {
  const Index n = bank.structure.dimension(), n_y = bank.C.rows();
  ImmFilter<any, any> general(bank, options);
  ImmFilter<N, NY> fixed(bank, options);
  general.start(run.state.col(0));
  fixed.start(run.state.col(0));
  VectorXd mean(n), expected_mean(n), pit(n_y), width = VectorXd::Zero(n_y), expected_pit(n_y), expected_width = width;
  MatrixXd covariance(n, n), expected_covariance(n, n), S(n_y, n_y), expected_S(n_y, n_y);
  const auto same = [&](const MatrixXd& a, const MatrixXd& b) {
    return test::near(a, b, relative * std::max(1e-3, b.cwiseAbs().maxCoeff()));
  };
  for (Index k = 1; k < run.samples(); ++k) {
    general.predict(run.input.col(k - 1));
    fixed.predict(run.input.col(k - 1));
    general.combine(expected_mean, expected_S);
    fixed.combine(mean, S);
    ASSERT_TRUE(same(mean, expected_mean)) << "sample " << k;
    ASSERT_TRUE(same(S, expected_S)) << "sample " << k;
    ASSERT_TRUE(same(fixed.predicted_probability(), general.predicted_probability())) << "sample " << k;
    double expected = general.update(run.state.col(k)), log_density = fixed.update(run.state.col(k));
    general.merge(expected_mean, expected_covariance);
    fixed.merge(mean, covariance);
    ASSERT_TRUE(same(mean, expected_mean)) << "sample " << k;
    ASSERT_TRUE(same(covariance, expected_covariance)) << "sample " << k;
    ASSERT_TRUE(same(fixed.mode_probability(), general.mode_probability())) << "sample " << k;
    ASSERT_EQ(std::isnan(log_density), std::isnan(expected));
    if (!std::isnan(expected)) {
      fixed.transform(run.state.col(k), pit, width, log_density);
      general.transform(run.state.col(k), expected_pit, expected_width, expected);
      ASSERT_TRUE(same(width, expected_width)) << "sample " << k;
      for (Index i = 0; i < n_y; ++i) {
        ASSERT_EQ(std::isnan(pit(i)), std::isnan(expected_pit(i)));
        if (std::isnan(pit(i))) continue;
        // The difference is relative to the smaller tail. In the upper tail, 1 - pit has fewer bits.
        const double tail = std::min(expected_pit(i), 1.0 - expected_pit(i));
        ASSERT_NEAR(pit(i), expected_pit(i), 1e-15 + 1e3 * relative * tail) << "sample " << k << ", signal " << i;
      }
      ASSERT_NEAR(log_density, expected, relative * std::max(1.0, std::abs(expected))) << "sample " << k;
    }
  }
}

void expect_agreement(const Bank& bank, const Trajectory& run, const FilterOptions& options, double relative) {
  with_sizes(bank.structure.dimension(), bank.C.rows(),
             [&]<int N, int NY>() { expect_agreement<N, NY>(bank, run, options, relative); });
}

/// The example's modes, slowed down so that many of them are stable. Their noises have the same order of magnitude.
Bank many_modes(Index n, Index K) {
  Bank bank = test::example_bank(n, 2, K);
  for (Index j = 0; j < K; ++j) {
    Mode& mode = bank.modes[static_cast<std::size_t>(j)];
    const double share = static_cast<double>(j) / static_cast<double>(K);
    mode.model.A = -(0.1 + 0.8 * share) * MatrixXd::Identity(n, n) + MatrixXd::Constant(n, n, 0.03);
    mode.Q = 1e-4 * (1.0 + 3.0 * share) * (MatrixXd::Identity(n, n) + MatrixXd::Constant(n, n, 0.3));
  }
  return bank;
}

TEST(FixedSizes, SaysWhatTheGeneralStepsSay) {
  for (const Index n : {1, 2, 3})
    for (const Index K : {2, 8, 9, 25}) {
      const Bank bank = many_modes(n, K);
      Trajectory run = test::simulate_bank(bank, 70, 51);
      run.state(0, 30) = std::nan("");  // first some signals are missing, later all signals
      run.state.col(40).setConstant(std::nan(""));
      run.state(0, 50) = std::nan("");  // an outlier in the available signals
      run.state(n - 1, 50) += n > 1 ? 0.5 : 0.0;
      run.state(n - 1, 60) += 3.0;
      SCOPED_TRACE(std::to_string(n) + " states, " + std::to_string(K) + " modes");
      expect_agreement(bank, run, {}, 1e-11);
    }
}

/// A quantum of about a standard deviation, a tiny quantum, and one continuous signal.
TEST(FixedSizes, ScoresIntervalsAsTheGeneralStepsDo) {
  for (const Index n : {1, 2, 3})
    for (const Index K : {2, 8, 9})
      for (const double quantum : {3e-2, 1e-6}) {
        Bank bank = many_modes(n, K);
        bank.quantum.setConstant(n, quantum);
        if (n == 3) bank.quantum(1) = 0.0;
        Trajectory run = test::simulate_bank(bank, 70, 51);
        for (Index i = 0; i < n; ++i)
          if (bank.quantum(i) > 0.0)
            run.state.row(i) = ((run.state.row(i) / quantum).array().round() * quantum).matrix();
        run.state(0, 30) = std::nan("");
        run.state.col(40).setConstant(std::nan(""));
        run.state(n - 1, 60) += 3.0;  // a measurement far out in a tail
        SCOPED_TRACE(testing::Message() << n << " states, " << K << " modes, quantum " << quantum);
        expect_agreement(bank, run, {}, 1e-9);
      }
}

TEST(FixedSizes, OneSignalOfSeveralStates) {
  for (const Index n : {2, 3, 4}) {
    Bank bank = many_modes(n, 5);
    bank.C = MatrixXd::Zero(1, n);
    bank.C(0, 0) = 2.0;
    bank.C(0, n - 1) = 0.3;
    bank.R = MatrixXd::Constant(1, 1, 1e-3);
    const Trajectory run = test::simulate_bank(bank, 60, 52);
    expect_agreement(bank, run, {}, 1e-11);
  }
}

TEST(FixedSizes, CorrelatedNoiseAndImpossibleModes) {
  Bank bank = many_modes(3, 4);
  bank.R << 2e-4, 1e-4, 0, 1e-4, 3e-4, -5e-5, 0, -5e-5, 1e-4;
  bank.initial_probability << 0.5, 0.5, 0.0, 0.0;
  bank.transition = TransitionMatrix(
      (MatrixXd(4, 4) << 0.9, 0.1, 0, 0, 0.2, 0.7, 0.1, 0, 0.3, 0.3, 0.4, 0, 0.5, 0.5, 0, 0).finished());
  Trajectory run = test::simulate_bank(bank, 80, 53);
  run.state(1, 20) = std::nan("");
  expect_agreement(bank, run, {}, 1e-11);
}

/// Phi(z) to 20 digits (mpmath), far into the lower tail. All modes are equal, so the transform is that of a single
/// normal distribution.
TEST(FixedSizes, TransformsByTheNormalDistributionFunction) {
  Bank bank = test::example_bank(1, 1, 3);
  for (Mode& mode : bank.modes) {
    mode.model = {MatrixXd::Constant(1, 1, -1.0), MatrixXd::Zero(1, 1), VectorXd::Zero(1)};  // predicts zero
    mode.Q.setConstant(1.0);
  }
  bank.R.setZero();
  const struct {
    double z, probability;
  } cases[] = {
      {-37.0, 5.7255712225245768227e-300}, {-30.0, 4.9067139271481870595e-198}, {-20.5, 1.0764673258790960335e-93},
      {-12.3, 4.5287069561587846514e-35},  {-8.0, 6.2209605742717841235e-16},   {-5.2, 9.9644263169334717467e-8},
      {-3.7, 0.00010779973347738826148},   {-2.4, 0.0081975359245961314334},    {-1.1, 0.13566606094638265582},
      {-0.6, 0.27425311775007358769},      {-0.05, 0.4800611941616275373},      {0.0, 0.5},
      {0.02, 0.50797831371690198119},      {0.9, 0.81593987465324051735},       {2.2, 0.98609655248650139569},
      {4.1, 0.99997934249308745323},       {7.7, 0.99999999999999319669},       {40.0, 1.0}};
  VectorXd pit(1), width(1);
  for (const auto& [z, probability] : cases) {
    ImmFilter<1, 1> fixed(bank, {});
    fixed.start(VectorXd::Zero(1));
    fixed.predict(VectorXd::Zero(1));
    const VectorXd y = VectorXd::Constant(1, z);
    double log_density = fixed.update(y);
    fixed.transform(y, pit, width, log_density);
    // z itself is rounded. This changes the tail in proportion to z^2.
    EXPECT_NEAR(pit(0), probability, (1e-14 + 2.3e-16 * z * z) * probability) << z;
  }
}

/// The modes' predictions are far apart and have small variances. Moments about the common mean would lose all digits.
TEST(FixedSizes, ModesFarApartKeepTheirVariances) {
  Bank bank = many_modes(2, 9);
  for (Mode& mode : bank.modes) mode.Q *= 1e-6;
  bank.R.setIdentity();
  bank.R *= 1e4;  // no measurement brings the modes closer together
  bank.transition = TransitionMatrix::sticky(9, 1.0 - 1e-9);
  for (Index j = 0; j < 9; ++j) bank.modes[static_cast<std::size_t>(j)].model.c.setConstant(static_cast<double>(j));
  const Trajectory run = test::simulate_bank(bank, 60, 55);
  expect_agreement(bank, run, {}, 1e-9);
}

}  // namespace
}  // namespace modebank
