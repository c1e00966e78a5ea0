// Filters of fixed sizes must give the bits of the same equations of dynamic size, in all results.
#include <gtest/gtest.h>

#include <cmath>

#include "filter/step/imm_filter.hpp"
#include "filter/step/samples.hpp"
#include "tests/filter/filter_test_support.hpp"

namespace modebank {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// All results of a filter over a run, sample by sample.
template <int N, int NY>
std::vector<double> results(const Bank& bank, const Trajectory& run, const FilterOptions& options) {
  ImmFilter<N, NY> filter(bank, options);
  VectorXd mean, pit(bank.C.rows()), width(bank.C.rows());
  MatrixXd S, covariance;
  std::vector<double> numbers;
  const auto add = [&](const auto& values) {
    for (const double value : values.reshaped()) numbers.push_back(std::isnan(value) ? -1.0 : value);
  };
  for_each_sample(bank, run, [&](const SampleFeed& feed, Index k, bool starts) {
    if (starts) return filter.start(feed.start());
    filter.predict(feed.inputs());
    filter.combine(mean, S);
    add(mean);
    add(S);
    add(filter.predicted_probability());
    double log_density = filter.update(run.state.col(k));
    if (!std::isnan(log_density)) {
      filter.transform(run.state.col(k), pit, width, log_density);
      add(pit);
      add(width);
    }
    add(VectorXd::Constant(1, log_density));
    filter.merge(mean, covariance);
    add(mean);
    add(covariance);
    add(filter.mode_probability());
  });
  return numbers;
}

void expect_same_bits(const Bank& bank, const Trajectory& run, const FilterOptions& options = {}) {
  const std::vector<double> fixed = with_sizes(bank.structure.dimension(), bank.C.rows(),
                                               [&]<int N, int NY>() { return results<N, NY>(bank, run, options); });
  ASSERT_GT(fixed.size(), 500U);
  EXPECT_EQ(fixed, (results<Eigen::Dynamic, Eigen::Dynamic>(bank, run, options)));
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

/// A quantum of about a standard deviation, a tiny quantum, and with three signals a continuous one among them.
TEST(FixedSizes, GiveTheBitsOfDynamicOnes) {
  for (const Index n : {1, 2, 3})
    for (const Index K : {1, 2, 8, 9, 25})
      for (const double quantum : {0.0, 3e-2, 1e-6})
        for (const FilterVariant variant : {FilterVariant::imm, FilterVariant::salvi2025, FilterVariant::kf}) {
          if (variant == FilterVariant::kf && K > 1) continue;
          Bank bank = many_modes(n, K);
          bank.quantum.setConstant(n, quantum);
          if (n == 3) bank.quantum(1) = 0.0;
          Trajectory run = test::simulate_bank(bank, 70, 51);
          if (quantum > 0.0)
            for (double& value : run.state.reshaped()) value = std::round(value / quantum) * quantum;
          run.state(0, 30) = std::nan("");  // first some signals are missing, later all signals
          run.state.col(40).setConstant(std::nan(""));
          run.state(0, 50) = std::nan("");  // an outlier in the available signals
          run.state(n - 1, 50) += n > 1 ? 0.5 : 0.0;
          run.state(n - 1, 60) += 3.0;  // a measurement far out in a tail
          run.state(0, 65) = 1e6;
          SCOPED_TRACE(testing::Message() << n << " states, " << K << " modes, quantum " << quantum);
          expect_same_bits(bank, run, {variant});
        }
}

TEST(FixedSizes, OneSignalOfSeveralStates) {
  for (const Index n : {2, 3}) {
    Bank bank = many_modes(n, 5);
    bank.C = MatrixXd::Zero(1, n);
    bank.C(0, 0) = 2.0;
    bank.C(0, n - 1) = 0.3;
    bank.R = MatrixXd::Constant(1, 1, 1e-3);
    expect_same_bits(bank, test::simulate_bank(bank, 60, 52));
  }
}

/// With lags, the filter starts from several measurements of a signal.
TEST(FixedSizes, LaggedSamples) {
  for (const Index lags : {2, 3}) {
    Bank bank = test::example_bank(1, 1, 3);
    bank.structure.state_lags = lags;
    for (Mode& mode : bank.modes) {
      mode.model = unpack(bank.structure, VectorXd::Constant(bank.structure.parameters(), -0.1));
      mode.parameter_covariance.resize(0, 0);
      const double q = mode.Q(0, 0);
      mode.Q = MatrixXd::Zero(lags, lags);
      mode.Q(0, 0) = q;
    }
    bank.C = MatrixXd::Identity(1, lags);
    Trajectory run = test::simulate_bank(test::example_bank(1, 1, 3), 60, 11);
    run.state(0, 30) = std::nan("");
    expect_same_bits(bank, run);
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
  expect_same_bits(bank, run);
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

}  // namespace
}  // namespace modebank
