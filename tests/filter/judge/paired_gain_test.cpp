// Gains and their standard errors: closed forms, and simulated series for which the variance of the mean is known.
#include <gtest/gtest.h>

#include <boost/random/normal_distribution.hpp>
#include <cmath>
#include <random>

#include "filter/judge/finding.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {
namespace {

using Eigen::VectorXd;

PairedGain gain_of(const std::vector<VectorXd>& differences) {
  std::vector<VectorXd> zeros;
  for (const VectorXd& run : differences) zeros.push_back(VectorXd::Zero(run.size()));
  return paired_gain("other", differences, zeros);
}

/// A first-order autoregression with mean m and innovation variance one. It starts from its stationary distribution.
VectorXd autoregression(double rho, double mean, Eigen::Index samples, std::mt19937_64& generator) {
  boost::random::normal_distribution<double> normal;
  VectorXd x(samples);
  double value = normal(generator) / std::sqrt(1.0 - rho * rho);
  for (double& sample : x) {
    sample = mean + value;
    value = rho * value + normal(generator);
  }
  return x;
}

// Runs of different lengths. The variance of the linearised ratio is computed by hand: sums 2, 8, 0, 6, 4 over 2, 4, 2,
// 1, 1 samples give m = 2, residuals -2, 0, -4, 4, 2 and SE = sqrt(5 / 4 * 40) / 10.
TEST(PairedGain, RunsCountByTheirSamples) {
  const PairedGain gain = gain_of({VectorXd::Constant(2, 1.0), VectorXd::Constant(4, 2.0), VectorXd::Zero(2),
                                   VectorXd::Constant(1, 6.0), VectorXd::Constant(1, 4.0)});
  EXPECT_DOUBLE_EQ(gain.gain, 2.0);
  EXPECT_NEAR(gain.standard_error, std::sqrt(50.0) / 10.0, 1e-15);
  EXPECT_EQ(gain.degrees_of_freedom, 4.0);
  EXPECT_NEAR(gain.margin, 2.7764451051977934 * gain.standard_error, 1e-12);  // t(0.975, 4): Abramowitz & Stegun, 26.10
  EXPECT_FALSE(gain.by_blocks);
  EXPECT_TRUE(gain.exceeds());
}

TEST(PairedGain, OnlySamplesThatBothScoredCount) {
  std::vector<VectorXd> bank, other(6, VectorXd::Zero(3));
  for (int r = 0; r < 6; ++r) bank.push_back(VectorXd::Constant(3, r < 5 ? 1.0 + r : not_a_number));
  bank[0](0) = other[0](1) = not_a_number;
  const PairedGain gain = paired_gain("other", bank, other);
  EXPECT_EQ(gain.samples, 13);
  EXPECT_NEAR(gain.gain, (1.0 + 3.0 * 14.0) / 13.0, 1e-15);
  EXPECT_EQ(gain.degrees_of_freedom, 4.0);  // no sample of the sixth run has both scores
  EXPECT_EQ(paired_gain("other", other, bank).gain, -gain.gain);
}

TEST(PairedGain, BlocksKnowAboutAutocorrelation) {
  std::mt19937_64 generator(41);
  for (const double rho : {0.0, 0.5, 0.8}) {
    const Eigen::Index samples = 20000;
    const PairedGain gain = gain_of({autoregression(rho, 0.3, samples, generator)});
    const double truth = 1.0 / (1.0 - rho) / std::sqrt(static_cast<double>(samples));
    EXPECT_TRUE(gain.by_blocks);
    // a block of two autocorrelation times contains most of the autocorrelation
    EXPECT_NEAR(gain.standard_error, truth, 0.25 * truth) << rho;
  }
}

/// By hand: if each of eight blocks gains one, the ranks are the most extreme possible, with probability 2^-8.
TEST(PairedGain, BlocksAreRankedToo) {
  VectorXd run(4000);
  std::mt19937_64 generator(7);
  for (double& d : run) d = 1.0 + 0.1 * (static_cast<double>(generator() % 1000) / 500.0 - 1.0);
  const PairedGain gain = gain_of({run});
  ASSERT_TRUE(gain.by_blocks);
  EXPECT_LT(gain.rank_p, std::pow(2.0, -8));
  EXPECT_TRUE(gain.told());
  run.head(3000).array() -= 2.0;
  EXPECT_GT(gain_of({run}).rank_p, 0.9);
  EXPECT_TRUE(std::isnan(gain_of({run.head(14)}).margin)) << "too few blocks know no error";
  EXPECT_TRUE(std::isnan(gain_of({VectorXd::Constant(4, not_a_number)}).gain));
}

// If two filters are equally good, a gain is significant in 2.5 % of the cases: 25 of 1000, with binomial sd 4.9.
TEST(PairedGain, ChanceExceedsTheMarginAsOftenAsItSays) {
  std::mt19937_64 generator(43);
  for (const int runs : {6, 3}) {
    int better = 0;
    for (int i = 0; i < 1000; ++i) {
      std::vector<VectorXd> differences;
      for (int r = 0; r < runs; ++r) differences.push_back(autoregression(0.5, 0.0, 150, generator));
      better += gain_of(differences).exceeds();
    }
    EXPECT_LE(better, 45) << runs;
    EXPECT_GE(better, 8) << runs;
  }
}

}  // namespace
}  // namespace modebank
