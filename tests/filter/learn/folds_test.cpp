// Splits for cross-validation.
#include "filter/learn/left_out/folds.hpp"

#include <gmock/gmock.h>

#include "tests/filter/learn/learn_test_support.hpp"

namespace modebank {
namespace {

TEST(ValidationSplits, LeaveEveryTrainingRunOutOnce) {
  Recording recording = test::empty_recording(1, 1);
  for (const Index samples : {30, 200, 60, 90, 40, 100, 20})
    test::add_run(recording, Eigen::MatrixXd::Zero(1, samples), Eigen::MatrixXd::Zero(1, samples));
  recording.runs.back().role = Role::test;
  const std::vector<ValidationSplit> splits = validation_splits(recording, 4);
  ASSERT_EQ(splits.size(), 4u);
  std::vector<std::string> left_out;
  for (const ValidationSplit& split : splits) {
    EXPECT_EQ(split.training.runs.size() + split.left_out.runs.size(), 6u);
    for (const Trajectory& run : split.left_out.runs) left_out.push_back(run.run);
  }
  EXPECT_THAT(left_out, testing::UnorderedElementsAre("run0", "run1", "run2", "run3", "run4", "run5"));
}

TEST(ValidationSplits, CutASingleRunIntoStretches) {
  Recording recording = test::empty_recording(1, 1);
  test::add_run(recording, Eigen::RowVectorXd::LinSpaced(103, 0.0, 102.0), Eigen::MatrixXd::Zero(1, 103));
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

}  // namespace
}  // namespace modebank
