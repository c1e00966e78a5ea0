// The part of a long recording that is drawn for learning.
#include <gmock/gmock.h>

#include <map>

#include "filter/learn/left_out/folds.hpp"
#include "tests/filter/learn/learn_test_support.hpp"

namespace modebank {
namespace {

/// Runs in which the state at sample k of run r is 1e6 r + k, so that each stretch can be identified.
Recording numbered(const std::vector<Index>& transitions) {
  Recording recording = test::empty_recording(1, 1);
  for (std::size_t r = 0; r < transitions.size(); ++r) {
    const double first = 1e6 * static_cast<double>(r), last = first + static_cast<double>(transitions[r]);
    const Index samples = transitions[r] + 1;
    test::add_run(recording, Eigen::RowVectorXd::LinSpaced(samples, first, last), Eigen::MatrixXd::Zero(1, samples));
  }
  return recording;
}

/// Number of drawn transitions per original run.
std::map<Index, Index> drawn_by_run(const Recording& part) {
  std::map<Index, Index> count;
  for (const Trajectory& run : part.runs) count[static_cast<Index>(run.state(0, 0) / 1e6)] += run.transitions();
  return count;
}

TEST(LearningPart, IsNoneWhereTheRunsHaveNoMore) {
  const Recording recording = numbered({300, 200});
  EXPECT_FALSE(learning_part(recording, 500, 1));
  EXPECT_FALSE(learning_part(recording, 0, 1));
  EXPECT_TRUE(learning_part(recording, 499, 1));
}

TEST(LearningPart, IsMadeOfWholeStretchesOfTheTrainingRuns) {
  Recording recording = numbered({40000, 10000, 90000});
  recording.runs[1].role = Role::test;
  const Recording part = learning_part(recording, 20000, 7).value();
  EXPECT_LE(part.transitions(Role::train), 20000);
  EXPECT_GE(part.transitions(Role::train), 19000) << "but for what two shares drew alike";
  EXPECT_EQ(part.transitions(Role::test), 0);
  double end = -1.0;
  for (const Trajectory& run : part.runs) {
    EXPECT_GE(run.transitions(), 100);
    EXPECT_EQ(run.state(0, run.samples() - 1) - run.state(0, 0), static_cast<double>(run.transitions()))
        << "a stretch has no gaps";
    EXPECT_GT(run.state(0, 0), end) << "in order, no sample's transition twice";
    end = run.state(0, run.samples() - 1);
  }
}

TEST(LearningPart, HasEveryRunInProportionToItsLength) {
  const Recording recording = numbered({50000, 100000, 250000});
  const std::map<Index, Index> drawn = drawn_by_run(learning_part(recording, 40000, 3).value());
  const double stretch = 400.0;  // a stretch is a hundredth of the drawn transitions; each run's part is exact to two
                                 // stretches
  EXPECT_NEAR(static_cast<double>(drawn.at(0)), 5000.0, 2.0 * stretch);
  EXPECT_NEAR(static_cast<double>(drawn.at(1)), 10000.0, 2.0 * stretch);
  EXPECT_NEAR(static_cast<double>(drawn.at(2)), 25000.0, 2.0 * stretch);
}

TEST(LearningPart, TakesShortRunsWhole) {
  const Recording recording = numbered(std::vector<Index>(1000, 20));
  const Recording part = learning_part(recording, 2000, 1).value();
  ASSERT_GE(part.runs.size(), 90u);
  for (std::size_t i = 0; i + 1 < part.runs.size(); ++i) EXPECT_EQ(part.runs[i].transitions(), 20);
}

TEST(LearningPart, DependsOnTheSeedAlone) {
  const Recording recording = numbered({30000, 70000});
  const auto starts = [&](std::uint64_t seed) {
    std::vector<double> first;
    const Recording part = learning_part(recording, 10000, seed).value();
    for (const Trajectory& run : part.runs) first.push_back(run.state(0, 0));
    return first;
  };
  EXPECT_EQ(starts(5), starts(5));
  EXPECT_NE(starts(5), starts(6));
}

}  // namespace
}  // namespace modebank
