#include "app/chain/expected_time.hpp"

#include <gmock/gmock.h>

#include <string>
#include <vector>

namespace modebank::test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class Lines : public Listener {
 public:
  void progress(const std::string& line) const override { lines.push_back(line); }
  mutable std::vector<std::string> lines;
};

Recording one_run(Index samples) {
  Recording recording;
  recording.states.push_back({"x", ""});
  recording.inputs = {{"u1", ""}, {"u2", ""}};
  Trajectory run;
  run.run = "a";
  run.time_s = Eigen::VectorXd::LinSpaced(samples, 0.0, static_cast<double>(samples - 1));
  run.state = Eigen::MatrixXd::Zero(1, samples);
  run.input = Eigen::MatrixXd::Zero(2, samples);
  recording.runs.push_back(run);
  return recording;
}

TEST(ExpectedTime, IsToldFromHalfAMinuteOn) {
  const Lines heard;
  tell_if_long(heard, "bank", 29.0, "--bank.refine none leaves this out");
  EXPECT_THAT(heard.lines, IsEmpty());
  tell_if_long(heard, "bank", 45.4, "--bank.refine none leaves this out");
  tell_if_long(heard, "bank", 600.0, "--bank.refine none leaves this out");
  EXPECT_THAT(heard.lines,
              ElementsAre("bank: expected to take 45 s of processor time; --bank.refine none leaves this out",
                          "bank: expected to take 10 min of processor time; --bank.refine none leaves this out"));
}

/// No line is printed for runs of the demo's size, but one is printed for a day at 10 Hz.
TEST(ExpectedTime, GrowsWithSamplesAndCoefficients) {
  const Recording few = one_run(1000), many = one_run(864'000);
  const LinearStructure structure{1, 2, false};
  EXPECT_LT(expected_learning_s(few, structure, {}), 30.0);
  EXPECT_LT(expected_learning_s(many, structure, {}), 30.0) << "a part of them teaches";
  RefineOptions all;
  all.transitions = 0;
  EXPECT_GT(expected_learning_s(many, structure, all), 30.0);
  EXPECT_LT(expected_learning_s(many, structure, {}), expected_learning_s(many, {1, 2, false, 8, 8}, {}));
  FitOptions window;
  EXPECT_LT(expected_windows_s(many, window), 30.0) << "the batch solver";
  window.solver = WindowSolver::ceres;
  EXPECT_GT(expected_windows_s(many, window), 30.0);
  window.step = 100;
  EXPECT_LT(expected_windows_s(many, window), 30.0);
}

TEST(ExpectedTime, OfMixturesIsBoundedByThePartThatIsCompared) {
  WindowFits windows;
  windows.structure = {1, 2, false};
  ClusterOptions options;
  windows.windows.resize(100'000);
  const double most = expected_mixture_s(windows, options);
  windows.windows.resize(1'000'000);
  EXPECT_EQ(expected_mixture_s(windows, options), most);
  options.selection.components = {3};
  EXPECT_LT(expected_mixture_s(windows, options), 0.1 * most);
}

}  // namespace
}  // namespace modebank::test
