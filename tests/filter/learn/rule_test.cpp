// The choice of a bank by left-out runs: paired losses, their errors, and the fewest modes.
#include "filter/learn/left_out/rule.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace modebank {
namespace {

const Eigen::VectorXd thousands = Eigen::Vector4d(1000.0, 1000.0, 1000.0, 1000.0);

/// A candidate whose runs score 2000 minus this number of nats per hundred samples.
LeftOutScores below(Eigen::Index modes, const Eigen::Vector4d& losses) {
  return {modes, Eigen::VectorXd::Constant(4, 2000.0) - 10.0 * losses};
}

// m = 100 / 4000, deviations from 1000 m: -15, 5, 15, -5; sqrt(4 / 3 * 500) / 4000.
TEST(ModelChoice, PairedLossIsClusteredByRun) {
  const PairedLoss loss =
      paired_loss(below(3, {0, 0, 0, 0}).log_likelihood, below(2, {1, 3, 4, 2}).log_likelihood, thousands);
  EXPECT_NEAR(loss.mean, 0.025, 1e-15);
  EXPECT_NEAR(loss.standard_error, std::sqrt(2000.0 / 3.0) / 4000.0, 1e-15);
}

/// A loss that is equal in every sample has a standard error of zero, whatever the lengths of the runs.
TEST(ModelChoice, RunsOfDifferentLengthDoNotBlurALossPerSample) {
  const Eigen::VectorXd lengths = Eigen::Vector3d(50.0, 100.0, 400.0);
  const PairedLoss loss = paired_loss(Eigen::VectorXd::Zero(3), -0.01 * lengths, lengths);
  EXPECT_NEAR(loss.mean, 0.01, 1e-15);
  EXPECT_NEAR(loss.standard_error, 0.0, 1e-15);
}

TEST(ModelChoice, ACandidateWithoutAScoreLosesInfinitely) {
  Eigen::VectorXd broken = Eigen::VectorXd::Zero(4);
  broken(2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isinf(paired_loss(Eigen::VectorXd::Zero(4), broken, thousands).mean));
  EXPECT_EQ(fewest_modes_as_good({{1, broken}, below(2, {0, 0, 0, 0})}, thousands), 1u);
}

TEST(ModelChoice, FewestModesWithinOneStandardError) {
  // Three modes lose 0.005 +- 0.015, two lose 0.01 +- 0.002, one loses 0.5.
  const std::vector<LeftOutScores> candidates{below(4, {0, 0, 0, 0}), below(3, {4, -2, 2, -2}),
                                              below(2, {1, 1.5, 0.5, 1}), below(1, {50, 50, 50, 50})};
  EXPECT_EQ(best_candidate(candidates), 0u);
  EXPECT_EQ(fewest_modes_as_good(candidates, thousands), 1u);
}

/// With few runs the standard error is unreliable. As the only criterion it would accept any loss.
TEST(ModelChoice, ALossAboveTheLimitIsNotExcusedByItsError) {
  // One mode loses 0.025 +- 0.095, or 0.015 +- 0.065.
  EXPECT_EQ(fewest_modes_as_good({below(2, {0, 0, 0, 0}), below(1, {30, -10, 0, -10})}, thousands), 0u);
  EXPECT_EQ(fewest_modes_as_good({below(2, {0, 0, 0, 0}), below(1, {20, -8, 2, -8})}, thousands), 1u);
}

TEST(ModelChoice, OfAsManyModesTheBestThatQualifies) {
  const std::vector<LeftOutScores> candidates{below(3, {0, 0, 0, 0}), below(2, {4, -2, 2, -2}),
                                              below(2, {3, -2, 1, -1})};
  EXPECT_EQ(fewest_modes_as_good(candidates, thousands), 2u);
  EXPECT_EQ(fewest_modes_as_good({candidates[0], candidates[0]}, thousands), 0u);
}

/// The gain must be log(7 / 0.05) nats over all samples; with many samples, 0.001 nats per sample.
TEST(Rule, TheLeastThatCountsIsAProbabilityOfErrorAndNotTooSmallToMatter) {
  EXPECT_NEAR(least_worth(1200.0), 4.94164242 / 1200.0, 1e-10);
  EXPECT_EQ(least_worth(1e6), 1e-3);
}

TEST(Rule, WhatIsAddedGainsMoreThanItsErrorAndTheLeast) {
  const Eigen::VectorXd samples = Eigen::VectorXd::Constant(6, 200.0);
  EXPECT_TRUE(is_worth_it({0.01, 0.005}, samples));
  EXPECT_FALSE(is_worth_it({0.01, 0.02}, samples)) << "less than its error";
  EXPECT_TRUE(is_worth_it({0.01, 0.02}, samples, 0.005)) << "of which so much counts";
  EXPECT_FALSE(is_worth_it({0.004, 0.0}, samples)) << "4.8 nats";
  EXPECT_TRUE(is_worth_it({0.004, 0.0}, 10.0 * samples)) << "48 nats";
  EXPECT_FALSE(is_worth_it({std::numeric_limits<double>::infinity(), 0.0}, samples)) << "one has no score";
}

}  // namespace
}  // namespace modebank
