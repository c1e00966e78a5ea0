// Mean NIS, and the interval of the verdict, with and without missing signals: closed forms and simulation.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "filter/judge/diagnostics.hpp"
#include "filter/judge/scores.hpp"
#include "filter/judge/statistics.hpp"
#include "ident/base/distributions.hpp"
#include "tests/filter/filter_test_support.hpp"

namespace modebank {
namespace {

using Eigen::Index;

SquaredDistances distances_of(const std::vector<double>& values, Index degrees = 1) {
  SquaredDistances distances;
  distances.begin_run();
  for (const double value : values) distances.add(value, degrees);
  return distances;
}

TEST(SquaredDistances, AMeanCountsSamplesByTheirDegrees) {
  SquaredDistances distances = distances_of({6.0}, 3);
  distances.add(1.0, 1);
  distances.begin_run();
  distances.add(5.0, 2);
  distances.add(std::nan(""), 0);                        // no signal
  EXPECT_DOUBLE_EQ(mean_distance(distances, 3.0), 6.0);  // sum 12 divided by 6 degrees, times 3
  EXPECT_TRUE(std::isnan(mean_distance({}, 1.0)));
  EXPECT_TRUE(std::isnan(mean_distance_interval({}, 1.0, 0.95).lower));
}

/// Quantiles of chi-square with 100 degrees of freedom are 74.22 and 129.56. The distribution of the degrees over the
/// samples does not matter.
TEST(SquaredDistances, TheIntervalIsThatOfTheSum) {
  SquaredDistances mixed = distances_of(std::vector<double>(20, 1.0));
  for (int k = 0; k < 20; ++k) mixed.add(4.0, 4);
  for (const SquaredDistances& whole :
       {distances_of(std::vector<double>(100, 1.0)), distances_of(std::vector<double>(25, 1.0), 4), mixed}) {
    const Interval interval = mean_distance_interval(whole, 1.0, 0.95);
    EXPECT_NEAR(interval.lower, 0.7422, 5e-5);
    EXPECT_NEAR(interval.upper, 1.2956, 5e-5);
    EXPECT_NEAR(mean_distance_interval(whole, 4.0, 0.95).upper, 4.0 * 1.2956, 2e-4);
  }
}

/// If every value occurs twice, the interval is that of half the number of values, apart from the margin.
TEST(SquaredDistances, RelatedSamplesAreFewer) {
  std::mt19937_64 generator(1);
  std::vector<double> once, twice;
  for (int i = 0; i < 4000; ++i) {
    once.push_back(static_cast<double>(generator() >> 11));
    twice.insert(twice.end(), {once.back(), once.back()});
  }
  const Interval a = mean_distance_interval(distances_of(once), 1.0, 0.95),
                 b = mean_distance_interval(distances_of(twice), 1.0, 0.95);
  EXPECT_NEAR((b.upper - b.lower) / (a.upper - a.lower), 1.0, 0.1);
}

/// A run of the bank. Each signal is missing independently with this probability.
Trajectory with_missing(const Bank& bank, double missing, Index samples, std::uint64_t seed) {
  Trajectory run = test::simulate_bank(bank, samples, seed);
  run.role = Role::test;
  std::mt19937_64 generator(seed + 1);
  std::uniform_real_distribution<double> uniform;
  for (Index k = 1; k < samples; ++k)
    for (double& value : run.state.col(k))
      if (uniform(generator) < missing) value = std::numeric_limits<double>::quiet_NaN();
  return run;
}

/// If signals are missing, the plain mean over samples would be about n_y (1 - missing).
TEST(SquaredDistances, ATrueFilterHasMeanNisOfItsSignalsWhateverIsMissing) {
  const Bank bank = test::single_mode(test::example_bank(3, 1, 1), 0);
  for (const double missing : {0.0, 0.3, 0.7}) {
    const std::vector<Trajectory> runs{with_missing(bank, missing, 6000, 3), with_missing(bank, missing, 6000, 5)};
    const std::vector<RunEvaluation> evaluations{evaluate_run(bank, runs[0], {}), evaluate_run(bank, runs[1], {})};
    const std::vector<RunScores> scores = score_runs(evaluations);
    const std::vector<SummaryRow> summary = summarize("bank", runs[0].role, runs, evaluations, scores);
    const DiagnosticsRow row =
        diagnose("bank", runs[0].role, bank, bank.mode_count() == 1, runs, evaluations, scores).front();
    const double signals = 2.0 * 6000.0 * 3.0 * (1.0 - missing);
    EXPECT_NEAR(row.nis_mean, 3.0, 4.0 * 3.0 * std::sqrt(2.0 / signals)) << missing;
    EXPECT_DOUBLE_EQ(row.nis_mean, summary.back().nis_mean) << missing;  // both tables must define the mean NIS in the
                                                                         // same way
    EXPECT_EQ(row.verdict, Calibration::calibrated) << missing;
  }
}

/// A NIS on the scale of all signals lies outside its region exactly if the original NIS lies outside the region for
/// its own degrees.
TEST(SquaredDistances, NisOfFewerSignalsIsDrawnWhereAllWouldBe) {
  RunEvaluation e;
  const double nan = std::nan("");
  e.pit = Eigen::MatrixXd{{nan, 0.5, 0.5, nan}, {nan, 0.5, nan, 0.5}};
  e.nis = Eigen::Vector4d(nan, 5.0, chi_square_quantile(0.975, 1.0), chi_square_quantile(0.025, 1.0));
  const Eigen::VectorXd drawn = nis_of_all_signals(e);
  EXPECT_TRUE(std::isnan(drawn(0)));
  EXPECT_EQ(drawn(1), 5.0);
  EXPECT_NEAR(drawn(2), chi_square_quantile(0.975, 2.0), 1e-9);
  EXPECT_NEAR(drawn(3), chi_square_quantile(0.025, 2.0), 1e-9);
}

}  // namespace
}  // namespace modebank
