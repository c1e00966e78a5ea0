#include "ident/fit/window_length.hpp"

#include "tests/ident/ident_test_support.hpp"

namespace modebank {
namespace {

const LinearStructure many_lags{1, 2, false, 8, 8};  // 24 regressors

/// Six runs of 1000 samples that switch between two motions every `stay` samples. With `stay` 0 there is one motion.
Recording switching_runs(Index stay) {
  std::mt19937_64 generator(5);
  boost::random::uniform_real_distribution<double> level(-1.0, 1.0);
  boost::random::normal_distribution<double> noise(0.0, 0.05);
  std::vector<Trajectory> runs;
  for (int r = 0; r < 6; ++r) {
    Eigen::MatrixXd x = Eigen::MatrixXd::Zero(1, 1000), u(2, 1000);
    for (double& value : u.reshaped()) value = level(generator);
    for (Index k = 0; k + 1 < x.cols(); ++k) {
      const bool second = stay > 0 && k / stay % 2 == 1;
      x(k + 1) = (second ? 0.4 : 0.8) * x(k) + (second ? 0.6 : 0.2) * (u(1, k) - u(0, k)) + noise(generator);
    }
    runs.push_back(test::make_run(x, u));
  }
  return test::make_recording(runs);
}

TEST(WindowLength, IsTwentyFiveForFewRegressors) {
  EXPECT_EQ(automatic_length(switching_runs(0), test::skid_structure), 25);
  EXPECT_EQ(automatic_length(switching_runs(0), {1, 2, true, 3, 2}), 25) << "eight regressors";
}

TEST(WindowLength, IsThreeSamplesPerRegressorWhereMotionStays) {
  EXPECT_EQ(automatic_length(switching_runs(0), many_lags), 72);
  EXPECT_EQ(automatic_length(switching_runs(500), many_lags), 72) << "a third of a stay is 167";
}

TEST(WindowLength, IsShorterWhereMotionChangesOften) {
  EXPECT_EQ(automatic_length(switching_runs(60), many_lags), 36) << "a third of a stay is 20";
  EXPECT_LT(automatic_length(switching_runs(150), many_lags), 72) << "a third of a stay is 50";
}

TEST(WindowLength, NeedsNoLongerRunsThanTheShortest) {
  Recording recording = switching_runs(0);
  for (Trajectory& run : recording.runs) {
    run.state = run.state.leftCols(40).eval();
    run.input = run.input.leftCols(40).eval();
    run.time_s = run.time_s.head(40).eval();
  }
  EXPECT_EQ(automatic_length(recording, many_lags), 25) << "36 and the lags before them do not fit into 39 transitions";
}

TEST(WindowLength, LookedAtRunsAreThoseThatTrain) {
  Recording recording = switching_runs(60);
  for (std::size_t i = 1; i < recording.runs.size(); ++i) recording.runs[i].role = Role::test;
  recording.runs[0] = switching_runs(0).runs[0];
  EXPECT_EQ(automatic_length(recording, many_lags), 72);
}

/// With a step of three transitions, 300,000 transitions have 100,000 windows.
TEST(WindowStep, LeavesAHundredThousandWindows) {
  Recording recording =
      test::make_recording({test::make_run(Eigen::MatrixXd::Zero(1, 300001), Eigen::MatrixXd::Zero(1, 300001))});
  EXPECT_EQ(automatic_step(recording), 3);
  recording.runs.front().role = Role::test;
  EXPECT_EQ(automatic_step(recording), 1);
}

}  // namespace
}  // namespace modebank
