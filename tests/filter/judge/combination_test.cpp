// Forecasts of several filters, combined by their past success.
#include "filter/judge/combination.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "ident/base/not_a_number.hpp"
#include "modebank/filter/forecast_weights.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using Eigen::Index;

constexpr double combined_digits = 1e-12;

/// Artificial Gaussian forecasts of N samples, h samples ahead.
HorizonEvaluation forecasts(Index N, const std::vector<Index>& horizons, unsigned seed, double deviation) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.0, deviation);
  HorizonEvaluation said = empty_horizons(horizons, 1, N);
  for (std::size_t h = 0; h < horizons.size(); ++h)
    for (Index k = horizons[h]; k < N; ++k) {
      const double error = said.error[h](0, k) = normal(random);
      said.log_density(h, k) = -0.5 * error * error - 0.919;
      said.pit[h](0, k) = 0.5 * std::erfc(-error / std::sqrt(2.0));
    }
  return said;
}

TEST(Combination, ALoneFilterAndEqualOnesAreThemselves) {
  const HorizonEvaluation one = forecasts(50, {1, 7}, 1, 1.0);
  for (const std::vector<HorizonEvaluation>& members : {std::vector{one}, {one, one, one}}) {
    const CombinedForecasts all = combine_forecasts(members);
    EXPECT_TRUE(test::near(all.predictions.log_density, one.log_density, combined_digits));
    for (std::size_t h = 0; h < 2; ++h)
      EXPECT_TRUE(test::near(all.predictions.error[h], one.error[h], combined_digits));
  }
}

/// Two filters, with the formula written out. The log odds of the forecast for sample k are a sum over samples j up to
/// k - h. Each term is 0.99^(k - h - j) times the difference of the log densities of sample j, divided by h.
TEST(Combination, AForecastHasTheWeightsOfItsOrigin) {
  const Index N = 60;
  const HorizonEvaluation a = forecasts(N, {1, 5}, 2, 1.0), b = forecasts(N, {1, 5}, 3, 1.3);
  const CombinedForecasts all = combine_forecasts({a, b});
  for (std::size_t at = 0; at < 2; ++at) {
    const Index h = a.horizons[at];
    const Eigen::RowVectorXd of_a = a.log_density.row(at), of_b = b.log_density.row(at);
    for (Index k = h; k < N; ++k) {
      double odds = 0.0;
      for (Index j = h; j <= k - h; ++j)
        odds += std::pow(0.99, static_cast<double>(k - h - j)) * (of_a(j) - of_b(j)) / static_cast<double>(h);
      const double weight = 1.0 / (1.0 + std::exp(-odds));
      EXPECT_NEAR(all.weight[at](0, k), weight, combined_digits);
      for (const auto member : {&HorizonEvaluation::error, &HorizonEvaluation::pit})
        EXPECT_NEAR((all.predictions.*member)[at](0, k),
                    weight * (a.*member)[at](0, k) + (1 - weight) * (b.*member)[at](0, k), combined_digits);
      EXPECT_NEAR(all.predictions.log_density(at, k),
                  std::log(weight * std::exp(of_a(k)) + (1 - weight) * std::exp(of_b(k))), combined_digits);
    }
  }
}

TEST(Combination, SamplesAreTheFirstFilters) {
  HorizonEvaluation bank = forecasts(30, {3}, 4, 1.0), other = forecasts(30, {3}, 5, 1.0);
  bank.log_density(0, 10) = other.log_density(0, 20) = not_a_number;
  const CombinedForecasts all = combine_forecasts({bank, other});
  EXPECT_TRUE(std::isnan(all.predictions.log_density(0, 10)));
  EXPECT_EQ(all.weight[0](0, 20), 1.0);
  EXPECT_NEAR(all.predictions.log_density(0, 20), bank.log_density(0, 20), combined_digits);
  EXPECT_NEAR(all.predictions.error[0](0, 20), bank.error[0](0, 20), combined_digits);
}

/// A held-out run starts with the weights that are most likely on the training runs.
TEST(Combination, HeldOutRunsStartWithStackedWeights) {
  constexpr Index N = 400;
  std::vector<Trajectory> runs(2);
  for (Trajectory& run : runs) run.state.setZero(1, N);
  runs[1].role = Role::test;
  const HorizonEvaluation bad = forecasts(N, {1}, 8, 3.0), good = forecasts(N, {1}, 9, 1.0);
  ForecastTables tables({"bank", "drifting"}, runs);
  tables.add(0, {bad, good});
  tables.start_as_trained();
  tables.add(1, {bad, good});
  const std::vector<CombinationRow> weights = tables.combination();
  ASSERT_EQ(weights.size(), 4);  // two roles of two filters
  EXPECT_EQ(weights[3].filter, "drifting");
  EXPECT_EQ(weights[3].role, Role::test);
  EXPECT_GT(weights[3].weight, 0.8);
  EXPECT_NEAR(weights[2].weight + weights[3].weight, 1.0, combined_digits);
  const auto scored = [](const HorizonEvaluation& said) {
    return std::vector<double>(said.log_density.data() + 1, said.log_density.data() + N);
  };
  const std::vector<double> stacked = filter::ForecastWeights::stacked({scored(bad), scored(good)});
  EXPECT_GT(stacked[1], 0.8);
  EXPECT_EQ(start_weights(weights, 1, {"bank", "drifting"}), stacked);
  const CombinedForecasts run = combine_forecasts({bad, good}, {stacked});
  EXPECT_NEAR(run.weight[0](1, 1), stacked[1], combined_digits);
  EXPECT_NEAR(weights[3].weight, run.weight[0].row(1).tail(N - 1).mean(), combined_digits);
  const std::vector<HorizonRow> rows = tables.horizons();
  ASSERT_EQ(rows.size(), 12);  // three filters, each for every run and for all runs of a role
  EXPECT_EQ(rows.back().filter, "combined");
  EXPECT_NEAR(rows.back().log_score, run.predictions.log_density.row(0).tail(N - 1).mean(), combined_digits);
  EXPECT_GT(rows.back().log_score, rows[7].log_score - 0.1);  // of `drifting` in the held-out run
}

TEST(Combination, LeftOutRowsChooseWeightsAndScoreAllTogether) {
  const HorizonEvaluation a = forecasts(60, {1, 5}, 10, 1.0), b = forecasts(60, {1, 5}, 11, 2.0);
  const std::vector<LeftOutRow> rows = left_out_rows({"bank", "baseline"}, {{a, b}, {b, a}});
  ASSERT_EQ(rows.size(), 6);  // rows: three filters, each with two horizons
  EXPECT_EQ(rows[5].filter, "combined");
  EXPECT_EQ(rows[0].samples, 2 * 59);
  EXPECT_NEAR(rows[0].log_score, (a.log_density.row(0).tail(59).sum() + b.log_density.row(0).tail(59).sum()) / 118.0,
              combined_digits);
  EXPECT_NEAR(rows[0].rmse(0),
              std::sqrt((a.error[0].rightCols(59).squaredNorm() + b.error[0].rightCols(59).squaredNorm()) / 118.0),
              combined_digits);
  const std::vector<std::vector<double>> start = start_weights(rows, {1, 5}, {"bank", "baseline"});
  ASSERT_EQ(start.size(), 2);
  EXPECT_NEAR(start[0][0], 0.5, 1e-3);  // the filters are equally good in every run
  EXPECT_TRUE(start_weights(rows, {1, 7}, {"bank", "baseline"}).empty());
  EXPECT_TRUE(start_weights(rows, {1}, {"bank", "nonlinear"}).empty());
}

}  // namespace
}  // namespace modebank
