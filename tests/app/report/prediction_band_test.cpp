#include "app/report/page/prediction_band.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "app/report/page/pit_histogram.hpp"
#include "tests/filter/filter_test_support.hpp"

namespace modebank::test {
namespace {

/// A measurement is outside the 95 % band exactly if its innovation exceeds 1.96 standard deviations.
TEST(PredictionBand, IsAboutTheExpectedMeasurement) {
  const Bank bank = example_bank(2, 1, 2, 1e-4);
  const Trajectory run = simulate_truth(bank, 60, 7).run;
  const RunEvaluation evaluation = evaluate_run(bank, run, {});
  const PredictionBand band = prediction_band(bank, evaluation, 0.95);
  ASSERT_EQ(band.center.rows(), bank.C.rows());
  for (Eigen::Index k = 1; k < run.samples(); ++k)
    for (Eigen::Index i = 0; i < bank.C.rows(); ++i) {
      const double sd = std::sqrt(evaluation.innovation_covariance(i * (bank.C.rows() + 1), k));
      EXPECT_NEAR(band.center(i, k), run.state(i, k) - evaluation.innovation(i, k), 1e-12);
      EXPECT_NEAR(band.half_width(i, k), 1.959963984540054 * sd, 1e-12);
    }
  EXPECT_THROW(prediction_band(bank, evaluation, 1.0), std::invalid_argument);
}

RunEvaluation with_pit(const Eigen::RowVectorXd& pit) {
  RunEvaluation evaluation;
  evaluation.pit = pit;
  return evaluation;
}

TEST(PitHistogram, EveryKnownTransformIsCountedOnce) {
  const RunEvaluation first = with_pit((Eigen::RowVectorXd(5) << std::nan(""), 0.0, 0.1, 0.25, 0.5).finished());
  const RunEvaluation second = with_pit((Eigen::RowVectorXd(2) << 0.99, 1.0).finished());
  const PitHistogram histogram = pit_histogram({"bank", {first, second}}, {0, 1}, 4);
  EXPECT_EQ(histogram.counts, Eigen::Vector4i(2, 1, 1, 2));
  EXPECT_EQ(histogram.samples, 6);
  EXPECT_EQ(histogram.expected, 1.5);
  EXPECT_THROW(pit_histogram({}, {}, 1), std::invalid_argument);
}

/// The binomial distribution function, computed in Python. Quantiles are rounded outwards.
/// 100 in 10 bins: P(X <= 4) = 0.0237, P(X <= 15) = 0.9601, P(X <= 16) = 0.9794.
/// 2394 in 20 bins: P(X <= 98) = 0.0210, P(X <= 99) = 0.0265, P(X <= 140) = 0.9722, P(X <= 141) = 0.9774.
TEST(PitHistogram, BandIsTheBinomials) {
  const RunEvaluation hundred = with_pit(Eigen::RowVectorXd::Constant(100, 0.5));
  EXPECT_EQ(pit_histogram({"bank", {hundred}}, {0}, 10).band.lower, 4.0);
  EXPECT_EQ(pit_histogram({"bank", {hundred}}, {0}, 10).band.upper, 16.0);
  const RunEvaluation many = with_pit(Eigen::RowVectorXd::Constant(2394, 0.5));
  EXPECT_EQ(pit_histogram({"bank", {many}}, {0}, 20).band.lower, 98.0);
  EXPECT_EQ(pit_histogram({"bank", {many}}, {0}, 20).band.upper, 141.0);
}

}  // namespace
}  // namespace modebank::test
