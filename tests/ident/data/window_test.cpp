#include "ident/data/window.hpp"

#include "ident/base/seed.hpp"
#include "tests/ident/ident_test_support.hpp"

namespace modebank {
namespace {

Trajectory run_of(Index samples, Role role = Role::train) {
  return test::make_run(Eigen::MatrixXd::Zero(1, samples), Eigen::MatrixXd::Zero(2, samples), role);
}

TEST(Windows, NeverCrossRunsAndCoverTrainingRunsOnly) {
  const Recording recording = test::make_recording({run_of(11), run_of(20, Role::test), run_of(5), run_of(8)});
  const WindowPlan windows(recording, 5, 2);
  // Runs with 10, 4 and 7 transitions: windows start at 0, 2, 4; no window; windows start at 0, 2.
  const std::vector<std::pair<Index, Index>> expected{{0, 0}, {0, 2}, {0, 4}, {3, 0}, {3, 2}};
  ASSERT_EQ(windows.count(), std::ssize(expected));
  for (Index i = 0; i < windows.count(); ++i) {
    EXPECT_EQ(windows.window(i).run, expected[i].first);
    EXPECT_EQ(windows.window(i).start, expected[i].second);
  }
}

TEST(Windows, OneFitsARunOfItsLength) {
  EXPECT_EQ(WindowPlan(test::make_recording({run_of(6)}), 5, 1).count(), 1);
  EXPECT_EQ(WindowPlan(test::make_recording({run_of(5)}), 5, 1).count(), 0);
  EXPECT_EQ(WindowPlan(test::make_recording({run_of(0), run_of(1)}), 1, 1).count(), 0);
}

TEST(Windows, RejectEmptyLengthAndStep) {
  const Recording recording = test::make_recording({run_of(6)});
  EXPECT_THROW(WindowPlan(recording, 0, 1), std::invalid_argument);
  EXPECT_THROW(WindowPlan(recording, 5, 0), std::invalid_argument);
}

TEST(Seed, HasTheStatedMixing) {
  // These numbers are printed by tests/golden/generate/derive_seed.py.
  EXPECT_EQ(derive_seed(0, ""), 12014417281350144652ULL);
  EXPECT_EQ(derive_seed(1, "simulate.modes", 7), 4341455876973663748ULL);
}

}  // namespace
}  // namespace modebank
