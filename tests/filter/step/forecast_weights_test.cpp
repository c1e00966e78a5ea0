// Weights of several forecasters by their log densities.
#include "modebank/filter/forecast_weights.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

namespace modebank::filter {
namespace {

constexpr double digits = 1e-14;
constexpr double silent = std::numeric_limits<double>::quiet_NaN();

double log_odds(const ForecastWeights& weights) { return std::log(weights.weights()[0] / weights.weights()[1]); }

/// Raftery et al.: the odds of two forecasters are the product of past density ratios. A ratio has the exponent
/// 0.99^age, with its age in samples.
TEST(ForecastWeights, OddsAreForgottenRatiosOfDensities) {
  ForecastWeights weights(2);
  EXPECT_EQ(weights.weights(), (std::vector<double>{0.5, 0.5}));
  weights.observe({1.0, 0.25});
  EXPECT_NEAR(log_odds(weights), 0.75, digits);
  weights.observe({-2.0, -1.5});
  EXPECT_NEAR(log_odds(weights), 0.99 * 0.75 - 0.5, digits);
  ForecastWeights far(2, 10);  // overlapping forecasts count as one together
  far.observe({1.0, 0.0});
  EXPECT_NEAR(log_odds(far), 0.1, digits);
}

TEST(ForecastWeights, MayStartUnequal) {
  ForecastWeights weights({1.0, 3.0}, 1);
  EXPECT_NEAR(weights.weights()[1], 0.75, digits);
  weights.observe({0.5, 0.25});
  EXPECT_NEAR(log_odds(weights), std::log(1.0 / 3.0) + 0.25, digits);
  weights.observe({0.0, 0.0});  // the starting weights are not discounted
  EXPECT_NEAR(log_odds(weights), std::log(1.0 / 3.0) + 0.99 * 0.25, digits);
  weights.restart();
  EXPECT_NEAR(weights.weights()[1], 0.75, digits);
}

/// Odds change only if both forecasters have a value for a sample.
TEST(ForecastWeights, TheSilentKeepTheirWeight) {
  ForecastWeights weights(3);
  weights.observe({0.3, -0.2, 0.1});
  const std::vector<double> before = weights.weights();
  weights.observe({1.0, 1.0, silent});
  EXPECT_NEAR(
      weights.weights()[2],
      std::pow(before[2], 0.99) / (std::pow(before[0], 0.99) + std::pow(before[1], 0.99) + std::pow(before[2], 0.99)),
      1e-12);
  const std::vector<double> once = weights.weights();
  weights.observe({silent, silent, silent});
  EXPECT_EQ(weights.weights(), once);
}

TEST(ForecastWeights, OneOfDensityZeroComesBack) {
  ForecastWeights weights(2);
  weights.observe({-std::numeric_limits<double>::infinity(), 0.0});
  EXPECT_LT(weights.weights()[0], 1e-300);
  for (int k = 0; k < 100; ++k) weights.observe({10.0, 0.0});
  EXPECT_GT(weights.weights()[0], 0.99);
}

TEST(ForecastWeights, DensitiesAreMixedByWeight) {
  EXPECT_NEAR(ForecastWeights::mixed_log_density({0.25, 0.75}, {std::log(2.0), std::log(4.0)}), std::log(3.5), digits);
  EXPECT_NEAR(ForecastWeights::mixed_log_density({0.2, 0.3, 0.5}, {std::log(2.0), silent, std::log(4.0)}),
              std::log((0.2 * 2 + 0.5 * 4) / 0.7), digits);
  EXPECT_TRUE(std::isnan(ForecastWeights::mixed_log_density({0.5, 0.5}, {silent, silent})));
  EXPECT_NEAR(ForecastWeights::mixed_log_density({0.5, 0.5}, {-1e6, -1e6}), -1e6, digits);
}

/// In each sample one forecaster has density zero. The most likely constant weight of a forecaster is then the share of
/// samples that it predicts.
TEST(ForecastWeights, StackedWeightsAreTheLikeliest) {
  const double never = -std::numeric_limits<double>::infinity();
  const std::vector<double> stacked = ForecastWeights::stacked({{1.0, 2.0, 0.5, never}, {never, never, never, 3.0}});
  EXPECT_NEAR(stacked[0], 0.75, 1e-12);
  EXPECT_NEAR(stacked[1], 0.25, 1e-12);
  // The derivative of log(2 w + 1 - w) + 2 log(w + 3 (1 - w)) is zero at w = -1/6. So the second forecaster gets all
  // the weight, except for the minimum weight of the first.
  const double ln2 = std::log(2.0), ln3 = std::log(3.0);
  EXPECT_NEAR(ForecastWeights::stacked({{ln2, 0.0, 0.0}, {0.0, ln3, ln3}})[0], 0.001, 2e-4);
  EXPECT_NEAR(ForecastWeights::stacked({{0.0, silent, ln2}, {silent, 1.0, 0.0}})[0], 1.0, 2e-3);
  EXPECT_EQ(ForecastWeights::stacked({{silent}, {silent}}), (std::vector<double>{0.5, 0.5}));
}

TEST(ForecastWeights, WhatCannotBeIsRefused) {
  EXPECT_THROW(ForecastWeights(0), std::invalid_argument);
  EXPECT_THROW(ForecastWeights(2, 0), std::invalid_argument);
  for (const std::vector<double>& start : {std::vector{0.0, 0.0}, {1.0, -1.0}, {1.0, silent}})
    EXPECT_THROW(ForecastWeights(start, 1), std::invalid_argument);
  EXPECT_THROW(ForecastWeights(2).observe({0.0}), std::invalid_argument);
}

}  // namespace
}  // namespace modebank::filter
