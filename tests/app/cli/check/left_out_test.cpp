// Which predictions of left-out runs are compared, for two configurations.
#include "app/cli/check/left_out.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace modebank::test {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Six runs that start at 0 s. Their log density is a value plus the number of the run.
LeftOut six_runs(Index samples, double period_s, double one_step, double common_step, double start_s = 0.0) {
  LeftOut left_out;
  left_out.period_s = period_s;
  for (int run = 0; run < 6; ++run) {
    const VectorXd time_s =
        VectorXd::LinSpaced(samples, start_s, start_s + period_s * static_cast<double>(samples - 1));
    left_out.runs.push_back(
        {time_s, VectorXd::Constant(samples, one_step + run), VectorXd::Constant(samples, common_step + run)});
  }
  return left_out;
}

TEST(CompareLeftOut, OneStepAheadAtTheSameRate) {
  LeftOut better = six_runs(50, 0.1, 1.5, 7.0);
  const LeftOut other = six_runs(50, 0.1, 1.0, 9.0);
  PairedGain gain = compare_left_out(better, other);
  EXPECT_NEAR(gain.gain, 0.5, 1e-12);
  EXPECT_NEAR(gain.standard_error, 0.0, 1e-12);
  EXPECT_EQ(gain.samples, 300);
  for (int run = 0; run < 6; ++run) better.runs[static_cast<std::size_t>(run)].one_step.array() += run % 2 ? 0.2 : -0.2;
  gain = compare_left_out(better, other);
  EXPECT_NEAR(gain.gain, 0.5, 1e-12);
  EXPECT_NEAR(gain.standard_error, 0.2 / std::sqrt(5.0), 1e-12) << "of six runs' means, sd 0.2 sqrt(6 / 5)";
}

TEST(CompareLeftOut, EquallyLongAheadAtTheSlowerOnesSamples) {
  const LeftOut slow = six_runs(40, 0.4, 1.0, 1.0);
  LeftOut fast = six_runs(160, 0.1, 99.0, 1.25, 0.03);  // samples are 0.03 s away from those of the slow configuration
  for (LeftOutRun& run : fast.runs)
    for (Index k = 0; k < 160; ++k)
      if (k % 4 != 0) run.common_step(k) = -1e9;  // the slow configuration has no samples at these times
  EXPECT_NEAR(compare_left_out(fast, slow).gain, 0.25, 1e-12);
  EXPECT_NEAR(compare_left_out(slow, fast).gain, -0.25, 1e-12);
  EXPECT_EQ(compare_left_out(fast, slow).samples, 240);
  for (LeftOutRun& run : fast.runs) run.common_step.resize(0);  // this length is not a whole number of samples
  EXPECT_TRUE(std::isnan(compare_left_out(fast, slow).gain));
}

TEST(CompareLeftOut, SaysNothingWhereFewSamplesAreCommon) {
  const LeftOut other = six_runs(50, 0.1, 1.0, 1.0);
  EXPECT_NEAR(compare_left_out(six_runs(50, 0.1, 2.0, 2.0, 1.0), other).gain, 1.0, 1e-12) << "40 of 50 are";
  EXPECT_TRUE(std::isnan(compare_left_out(six_runs(50, 0.1, 2.0, 2.0, 3.0), other).gain)) << "20 of 50 are";
}

TEST(PlanLeftOut, DealsTrainingRunsByLength) {
  DataCheck check;
  for (const Index transitions : {10, 90, 50, 40, 30, 1000}) {
    RunReport& run = check.runs.emplace_back();
    run.run = std::to_string(check.runs.size());
    run.role = transitions == 1000 ? Role::test : Role::train;
    run.transitions = transitions;
  }
  const LeftOutPlan plan = plan_left_out(check);
  const std::vector<std::vector<std::string>> parts{{"2"}, {"1", "3"}, {"4", "5"}};
  EXPECT_EQ(plan.parts, parts) << "90; 50 + 10; 40 + 30; nothing that is held out";
  check.runs.resize(2);
  EXPECT_TRUE(plan_left_out(check).parts.empty()) << "too few to leave whole ones out";
}

}  // namespace
}  // namespace modebank::test
