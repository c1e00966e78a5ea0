// Splits for cross-validation, and the part of a long recording that is drawn for learning.
#include "filter/learn/left_out/folds.hpp"

#include <gmock/gmock.h>

#include <map>

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

TEST(ValidationSplits, LeaveEveryTrainingRunOutOnce) {
  Recording recording = numbered({30, 200, 60, 90, 40, 100, 20});
  recording.runs.back().role = Role::test;
  const std::vector<ValidationSplit> splits = validation_splits(recording, 4);
  ASSERT_EQ(splits.size(), 4u);
  std::vector<std::string> left_out;
  for (const ValidationSplit& split : splits) {
    EXPECT_EQ(split.training.runs.size() + split.left_out.runs.size(), 6u);
    EXPECT_GE(split.left_out.transitions(Role::train), 90) << "parts of about equal size";
    for (const Trajectory& run : split.left_out.runs) left_out.push_back(run.run);
  }
  EXPECT_THAT(left_out, testing::UnorderedElementsAre("run0", "run1", "run2", "run3", "run4", "run5"));
}

TEST(ValidationSplits, CutASingleRunIntoStretches) {
  const Recording recording = numbered({102});
  const std::vector<ValidationSplit> splits = validation_splits(recording, 4);
  ASSERT_EQ(splits.size(), 4u);
  Index samples = 0;
  double sum = 0.0;
  for (const ValidationSplit& split : splits)
    for (const Trajectory& run : split.left_out.runs) {
      samples += run.samples();
      sum += run.state.sum();
    }
  EXPECT_EQ(samples, 103);
  EXPECT_EQ(sum, 102.0 * 103.0 / 2.0);
  EXPECT_TRUE(validation_splits(recording, 1).empty());
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

TEST(LearningPart, HasEveryRunInProportionToItsLengthAndDependsOnTheSeed) {
  const auto drawn_by = [](std::uint64_t seed) {
    return learning_part(numbered({50000, 100000, 250000}), 40000, seed).value();
  };
  const Recording part = drawn_by(3);
  EXPECT_EQ(drawn_by(3).runs[0].state, part.runs[0].state);
  EXPECT_NE(drawn_by(4).runs[0].state, part.runs[0].state);
  std::map<Index, Index> drawn;
  for (const Trajectory& run : part.runs) drawn[static_cast<Index>(run.state(0, 0) / 1e6)] += run.transitions();
  const double two_stretches = 800.0;  // a stretch is a hundredth of the drawn transitions
  EXPECT_NEAR(static_cast<double>(drawn.at(0)), 5000.0, two_stretches);
  EXPECT_NEAR(static_cast<double>(drawn.at(1)), 10000.0, two_stretches);
  EXPECT_NEAR(static_cast<double>(drawn.at(2)), 25000.0, two_stretches);
}

TEST(LearningPart, TakesShortRunsWhole) {
  const Recording recording = numbered(std::vector<Index>(1000, 20));
  EXPECT_FALSE(learning_part(recording, 20000, 1)) << "no more runs than that";
  EXPECT_FALSE(learning_part(recording, 0, 1));
  const Recording part = learning_part(recording, 2000, 1).value();
  ASSERT_GE(part.runs.size(), 90u);
  for (std::size_t i = 0; i + 1 < part.runs.size(); ++i) EXPECT_EQ(part.runs[i].transitions(), 20);
}

}  // namespace
}  // namespace modebank
