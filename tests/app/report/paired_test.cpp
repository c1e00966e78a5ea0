// Pairs of modes from two banks, of samples from two archives, and of repeats of two settings.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "app/report/page/matched_modes.hpp"
#include "app/report/page/paired_runs.hpp"
#include "app/report/page/study_page.hpp"

namespace modebank::test {
namespace {

using app::report::gain_between;
using app::report::match_modes;
using app::report::MatchedMode;
using Eigen::Index;

/// A bank with one state, one input and no constant term. theta = (A, B), and both have the standard error `error`.
Bank bank_of(const std::vector<Eigen::Vector2d>& thetas, double error) {
  Bank bank;
  bank.structure.inputs = 1;
  bank.state_names = {"x"};
  bank.input_names = {"u"};
  for (const Eigen::Vector2d& theta : thetas) {
    Mode mode;
    mode.model = unpack(bank.structure, theta);
    mode.standard_error = Eigen::Vector2d::Constant(error);
    bank.modes.push_back(mode);
  }
  return bank;
}

std::vector<Eigen::Vector2d> random_thetas(int count, std::mt19937_64& generator) {
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  std::vector<Eigen::Vector2d> thetas;
  for (int i = 0; i < count; ++i) thetas.emplace_back(any(generator), any(generator));
  return thetas;
}

TEST(MatchedModes, AreTheSameOnesInAnotherOrder) {
  std::mt19937_64 generator(3);
  std::vector<Eigen::Vector2d> thetas = random_thetas(7, generator);
  const Bank first = bank_of(thetas, 0.05);
  std::vector<std::size_t> order(7);
  std::iota(order.begin(), order.end(), 0u);
  std::shuffle(order.begin(), order.end(), generator);
  std::vector<Eigen::Vector2d> shuffled;
  for (const std::size_t k : order) shuffled.push_back(thetas[k] + Eigen::Vector2d(0.01, -0.02));
  const auto match = match_modes(first, bank_of(shuffled, 0.05));
  ASSERT_EQ(match.difference, "");
  ASSERT_EQ(match.modes.size(), 7u);
  for (const MatchedMode& pair : match.modes) {
    EXPECT_EQ(order[static_cast<std::size_t>(pair.second)], static_cast<std::size_t>(pair.first));
    const double error = 0.05 * std::sqrt(2.0);
    EXPECT_NEAR(pair.z(0), 0.01 / error, 1e-12);
    EXPECT_NEAR(pair.distance, std::hypot(0.01, 0.02) / error / std::sqrt(2.0), 1e-12);
    EXPECT_TRUE(pair.agree());
  }
}

/// No other permutation has a smaller sum of log(1 + distance^2).
TEST(MatchedModes, AreTheBestOfAllPermutations) {
  std::mt19937_64 generator(5);
  for (int trial = 0; trial < 10; ++trial) {
    const auto one = random_thetas(5, generator), other = random_thetas(5, generator);
    const auto cost = [&](std::size_t a, std::size_t b) {
      return std::log1p((one[a] - other[b]).squaredNorm() / (2 * 0.1 * 0.1) / 2);
    };
    std::vector<std::size_t> order(5);
    std::iota(order.begin(), order.end(), 0u);
    double least = INFINITY;
    do {
      double sum = 0.0;
      for (std::size_t a = 0; a < 5; ++a) sum += cost(a, order[a]);
      least = std::min(least, sum);
    } while (std::next_permutation(order.begin(), order.end()));
    double sum = 0.0;
    for (const MatchedMode& pair : match_modes(bank_of(one, 0.1), bank_of(other, 0.1)).modes)
      sum += std::log1p(pair.distance * pair.distance);
    EXPECT_NEAR(sum, least, 1e-12);
  }
}

TEST(MatchedModes, LeaveOverWhatOneHasMore) {
  const Bank first = bank_of({{-0.5, 1.0}, {0.0, 0.0}, {-0.9, 2.0}}, 0.1),
             second = bank_of({{-0.91, 2.01}, {-0.5, 1.3}}, 0.1);
  const auto match = match_modes(first, second);
  ASSERT_EQ(match.modes.size(), 3u);
  EXPECT_EQ(match.modes[0].second, 1);
  EXPECT_FALSE(match.modes[0].agree() && std::abs(match.modes[0].z(1)) > 3.0);
  EXPECT_EQ(match.modes[1].second, -1);
  EXPECT_EQ(match.modes[2].second, 0);
  Bank other = second;
  other.input_names = {"v"};
  EXPECT_NE(match_modes(first, other).difference, "");
}

/// The numbers of modes are arbitrary. Modes that are probable at the same samples match, whatever their parameters.
TEST(MatchedModes, HaveTimeInCommon) {
  const Bank first = bank_of({{-0.5, 1.0}, {0.0, 0.0}, {-0.9, 2.0}}, 0.1),
             second = bank_of({{-0.5, 1.0}, {0.0, 0.0}}, 0.1);
  Eigen::MatrixXd shared(3, 2);
  shared << 0.01, 0.9,  // by their parameters, the first modes of both banks would match
      0.6, 0.02, 0.05, 0.02;
  const auto match = match_modes(first, second, shared);
  ASSERT_EQ(match.modes.size(), 3u);
  EXPECT_TRUE(match.by_time);
  EXPECT_EQ(match.modes[0].second, 1);
  EXPECT_EQ(match.modes[0].shared, 0.9);
  EXPECT_EQ(match.modes[1].second, 0);
  EXPECT_NEAR(match.modes[1].z(0), -0.5 / (0.1 * std::sqrt(2.0)), 1e-12);
  EXPECT_EQ(match.modes[2].second, -1);
  EXPECT_TRUE(std::isnan(match.modes[2].shared));
}

/// Modes that are probable at different times do not match, even if their parameters are similar.
TEST(MatchedModes, ThatNeverRuleTogetherStayAlone) {
  const Bank bank = bank_of({{-0.5, 1.0}, {0.0, 0.0}}, 0.1);
  Eigen::MatrixXd shared(2, 2);
  shared << 0.5, 0.4, 0.0, 0.05;
  const auto match = match_modes(bank, bank, shared);
  ASSERT_EQ(match.modes.size(), 2u);
  EXPECT_EQ(match.modes[0].second, 0);
  EXPECT_EQ(match.modes[1].second, 1);
  shared(1, 1) = 0.0;
  shared(1, 0) = 0.05;
  const auto apart = match_modes(bank, bank, shared);  // with 0.5 and 0 instead of 0.4 and 0.05
  ASSERT_EQ(apart.modes.size(), 3u);
  EXPECT_EQ(apart.modes[0].second, 0);
  EXPECT_EQ(apart.modes[1].second, -1);
  EXPECT_EQ(apart.modes[2].first, -1);
  EXPECT_EQ(apart.modes[2].second, 1);
}

TEST(MatchedModes, OfABankOfOneModeIsTheOneUsedMost) {
  const auto match =
      match_modes(bank_of({{0.0, 0.0}}, 0.1), bank_of({{0.0, 0.0}, {5.0, 5.0}}, 0.1), Eigen::RowVector2d(0.33, 0.67));
  ASSERT_EQ(match.modes.size(), 2u);
  EXPECT_EQ(match.modes[0].second, 1);
  EXPECT_EQ(match.modes[0].shared, 0.67);
  EXPECT_EQ(match.modes[1].second, 0);
}

TEST(MatchedModes, OfOtherModelsAreMatchedByTimeAlone) {
  const Bank first = bank_of({{-0.5, 1.0}, {0.0, 0.0}}, 0.1);
  Bank second = first;
  second.input_names = {"v"};
  const auto match = match_modes(first, second, Eigen::Matrix2d{{0.1, 0.9}, {0.8, 0.2}});
  EXPECT_NE(match.difference, "");
  ASSERT_EQ(match.modes.size(), 2u);
  EXPECT_EQ(match.modes[0].second, 1);
  EXPECT_EQ(match.modes[0].z.size(), 0);
  EXPECT_FALSE(match.modes[0].agree());
}

/// Six held-out runs with the same rate. `gains[r]`: how much better every sample of run r is predicted.
Archive archive_with(const std::vector<double>& gains) {
  Archive archive;
  archive.recording.emplace();
  FilterEvaluation evaluation;
  evaluation.filter = "bank";
  for (std::size_t r = 0; r < gains.size(); ++r) {
    Trajectory run;
    run.run = std::to_string(r);
    run.role = Role::test;
    run.time_s = Eigen::VectorXd::LinSpaced(50, 0.0, 4.9);
    run.state = Eigen::MatrixXd::Constant(1, 50, static_cast<double>(r));
    archive.recording->runs.push_back(run);
    RunEvaluation scored;
    scored.log_density = Eigen::VectorXd::Constant(50, gains[r]);
    scored.log_density(0) = NAN;
    evaluation.runs.push_back(scored);
  }
  archive.evaluations.push_back(evaluation);
  SummaryRow row;
  row.filter = "bank";
  row.run = "*";
  row.role = Role::test;
  archive.summary.push_back(row);
  return archive;
}

/// The runs have equal length, so the error is that of the mean of six numbers.
TEST(PairedRuns, TheErrorIsThatOfTheRunsMeans) {
  const std::vector<double> gains{0.1, 0.3, 0.2, -0.1, 0.4, 0.15};
  const auto result = gain_between(archive_with(gains), archive_with(std::vector<double>(6, 0.0)));
  const double mean = std::accumulate(gains.begin(), gains.end(), 0.0) / 6;
  double squares = 0.0;
  for (const double gain : gains) squares += (gain - mean) * (gain - mean);
  EXPECT_EQ(result.runs, 6);
  EXPECT_NEAR(result.gain.gain, mean, 1e-12);
  EXPECT_NEAR(result.gain.standard_error, std::sqrt(squares / 5 / 6), 1e-12);
  EXPECT_NEAR(result.gain.margin, 2.5705818356363 * std::sqrt(squares / 5 / 6), 1e-9);  // t(0.975, 5)
}

TEST(PairedRuns, OtherSamplesDoNotCount) {
  Archive first = archive_with({0.1, 0.2, 0.3}), second = archive_with({0.0, 0.0, 0.0});
  second.recording->runs[1].state *= 2.0;     // other measurements
  second.recording->runs[2].run = "another";  // another run
  EXPECT_EQ(gain_between(first, second).runs, 1);
  second.recording->runs[0].time_s *= 2.0;
  const auto none = gain_between(first, second);
  EXPECT_EQ(none.runs, 0);
  EXPECT_TRUE(std::isnan(none.gain.gain));
  EXPECT_NE(none.difference, "");
}

/// The first archive has two modes and the second has three. The measurements of the runs differ.
TEST(PairedRuns, TimeInCommonIsThatOfCommonRuns) {
  Archive first = archive_with({0.0, 0.0}), second = first;
  for (std::size_t r = 0; r < 2; ++r) {
    first.evaluations[0].runs[r].mode_probability = Eigen::Vector2d(0.75, 0.25).replicate(1, 50);
    second.evaluations[0].runs[r].mode_probability = Eigen::Vector3d(0.5, 0.5, 0.0).replicate(1, 50);
    second.evaluations[0].runs[r].mode_probability(0, 0) = NAN;  // here the filter has not started
  }
  second.recording->runs[1].state *= 2.0;
  const Eigen::MatrixXd shared = app::report::time_in_common(first, second);
  ASSERT_EQ(shared.rows(), 2);
  ASSERT_EQ(shared.cols(), 3);
  EXPECT_NEAR(shared(0, 0), 0.5 / 0.75, 1e-12);
  EXPECT_NEAR(shared(1, 1), 0.25 / 0.5, 1e-12);
  EXPECT_EQ(shared(0, 2), 0.0);
  // A bank shares all time with itself, however undecided its probabilities are.
  EXPECT_TRUE(app::report::time_in_common(first, first).diagonal().isOnes(1e-12));
  second.recording->runs.clear();
  EXPECT_EQ(app::report::time_in_common(first, second).size(), 0);
}

TEST(RepeatGain, IsPairedByRepeat) {
  app::StudyTable table;
  table.score_names = {"bank_test_log_score"};
  for (const double score : {1.0, 2.0, 3.0, 0.8, 1.9, 2.7}) {
    app::TrialRow row;
    row.repeat = static_cast<std::int64_t>(table.rows.size() % 3);
    row.scores = {score};
    table.rows.push_back(row);
  }
  const auto gain = app::report::repeat_gain(table, {0, 1, 2}, {3, 4, 5}, 0);
  EXPECT_EQ(gain.repeats, 3);
  EXPECT_NEAR(gain.gain, 0.2, 1e-12);
  EXPECT_NEAR(gain.standard_error, 0.1 / std::sqrt(3.0), 1e-12);  // standard error of the mean of 0.2, 0.1, 0.3
  EXPECT_NEAR(gain.margin, 4.302652729749464 * 0.1 / std::sqrt(3.0), 1e-9);
  EXPECT_TRUE(std::isnan(app::report::repeat_gain(table, {0}, {3}, 0).margin));
  EXPECT_EQ(app::report::repeat_gain(table, {0}, {4}, 0).repeats, 0);
}

}  // namespace
}  // namespace modebank::test
