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
  return {modes, Eigen::VectorXd::Constant(4, 2000.0) - 10.0 * losses, modes};
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
  EXPECT_EQ(fewest_motions_as_good({{1, broken, 1}, below(2, {0, 0, 0, 0})}, 1e9), 1u);
}

/// A candidate of four runs.
LeftOutScores scored(Eigen::Index motions, Eigen::Index modes, const Eigen::Vector4d& nats) {
  return {modes, nats, motions};
}

TEST(ModelChoice, FewestMotionsWithinTheLimitThenFewestModes) {
  const std::vector<LeftOutScores> candidates{scored(3, 3, {5, 5, 5, 5}), scored(2, 2, {4, 2, 2, 2}),
                                              scored(2, 4, {5, 4, 3, 1}), scored(1, 1, {0, -9, 2, 3}),
                                              scored(2, 2, {4, 3, 2, 2})};
  EXPECT_EQ(best_candidate(candidates), 0u);
  EXPECT_EQ(fewest_motions_as_good(candidates, 12.0), 4u) << "of as many motions and modes the best";
  EXPECT_EQ(fewest_motions_as_good(candidates, 1.0), 0u);
  EXPECT_EQ(fewest_motions_as_good(candidates, 8.0), 4u);
  EXPECT_EQ(fewest_motions_as_good(candidates, 25.0), 3u);
  EXPECT_EQ(fewest_motions_as_good({candidates[0], candidates[0]}, 12.0), 0u);
}

/// The loss of one motion is within the limit, but nearly every run tells.
TEST(ModelChoice, ARareMotionStaysWhereMostRunsGainByIt) {
  const auto chosen = [](const Eigen::Vector4d& nats) {
    return fewest_motions_as_good({scored(1, 1, {0, 0, 0, 0}), scored(2, 2, nats)}, 300.0);
  };
  EXPECT_EQ(chosen({6, 7, 8, 6}), 1u);
  EXPECT_EQ(chosen({5, 70, 80, 60}), 0u) << "three quarters of the runs";
}

/// The gain must be log(6 / 0.05) nats over all samples; with many samples, 0.001 nats per sample.
TEST(Rule, TheLeastThatCountsIsAProbabilityOfErrorAndNotTooSmallToMatter) {
  EXPECT_NEAR(least_worth(1200.0), 4.78749174 / 1200.0, 1e-10);
  EXPECT_EQ(least_worth(1e6), 1e-3);
}

TEST(Rule, WhatIsAddedGainsMoreThanItsErrorAndTheLeast) {
  const Eigen::VectorXd samples = Eigen::VectorXd::Constant(6, 200.0);
  EXPECT_TRUE(is_worth_it({0.01, 0.005}, samples));
  EXPECT_FALSE(is_worth_it({0.01, 0.02}, samples)) << "less than its error";
  EXPECT_FALSE(is_worth_it({0.0039, 0.0}, samples)) << "4.7 nats";
  EXPECT_TRUE(is_worth_it({0.004, 0.0}, 10.0 * samples)) << "48 nats";
  EXPECT_FALSE(is_worth_it({std::numeric_limits<double>::infinity(), 0.0}, samples)) << "one has no score";
}

}  // namespace
}  // namespace modebank
