#include "filter/prediction_band.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "filter/calibration.hpp"
#include "tests/filter/filter_test_support.hpp"

namespace modebank::test {
namespace {

/// The measurement lies outside the 95 % band exactly where its innovation is beyond 1.96 standard deviations.
TEST(PredictionBand, IsAboutTheExpectedMeasurement) {
  const Bank bank = example_bank(2, 1, 2, 1e-4);
  const Trajectory run = simulate_truth(bank, 60, 7).run;
  const RunEvaluation evaluation = evaluate_run(bank, run, {});
  const PredictionBand band = prediction_band(bank, evaluation, 0.95);
  ASSERT_EQ(band.lower.rows(), bank.C.rows());
  for (Eigen::Index k = 1; k < run.samples(); ++k)
    for (Eigen::Index i = 0; i < bank.C.rows(); ++i) {
      const double sd = std::sqrt(evaluation.innovation_covariance(i * (bank.C.rows() + 1), k));
      EXPECT_NEAR(band.centre(i, k), run.state(i, k) - evaluation.innovation(i, k), 1e-12);
      EXPECT_NEAR(band.upper(i, k) - band.centre(i, k), 1.959963984540054 * sd, 1e-12);
      EXPECT_NEAR(band.centre(i, k) - band.lower(i, k), 1.959963984540054 * sd, 1e-12);
    }
  EXPECT_THROW(prediction_band(bank, evaluation, 1.0), std::invalid_argument);
}

TEST(UniformCounts, EveryValueOfTheUnitIntervalIsCountedOnce) {
  EXPECT_EQ(uniform_counts({0.0, 0.1, 0.25, 0.5, 0.99, 1.0, std::nan(""), -0.1, 1.1}, 4),
            (std::vector<Eigen::Index>{2, 1, 1, 2}));
}

/// scipy.stats.binom(n, 1/bins).ppf([0.025, 0.975]), rounded outwards where the quantile is not exact.
TEST(UniformCounts, IntervalIsTheBinomials) {
  const CountInterval hundred = uniform_count_interval(100, 10, 0.95);
  EXPECT_EQ(hundred.lower, 4.0);
  EXPECT_EQ(hundred.upper, 16.0);
  const CountInterval many = uniform_count_interval(2394, 20, 0.95);
  EXPECT_EQ(many.lower, 98.0);
  EXPECT_EQ(many.upper, 141.0);
}

}  // namespace
}  // namespace modebank::test
