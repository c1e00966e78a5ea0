// The number of windows that each solver solves, and windows in chunks.
#include <gtest/gtest.h>

#include "ident/fit/fit_windows.hpp"
#include "modebank/base/error.hpp"
#include "tests/ident/fit/batch_test_support.hpp"

namespace modebank {
namespace {

using test::hard_recording;

TEST(BatchSolverOption, SaysWhatItCannotDo) {
  const Recording recording = hard_recording({2, 1, false}, 100, false);
  FitOptions o;
  o.solver = WindowSolver::batch;
  EXPECT_THROW(fit_windows(recording, o), ConfigurationError);
  o.solver = WindowSolver::automatic;
  EXPECT_EQ(test::by_batch(fit_windows(recording, o)), 0);
  o.solver = WindowSolver::batch;
  o.model = "slip";
  EXPECT_THROW(fit_windows(recording, o), ConfigurationError);
}

TEST(WindowSolverAuto, DependsOnTheNumberOfWindowsAlone) {
  std::mt19937_64 generator(5);
  FitOptions o;
  const auto recording = [&](Index windows) {
    return test::make_recording(
        {test::gaussian_run(test::skid_structure, test::skid_theta, 0.05, windows + o.length, generator)});
  };
  const WindowFits few = fit_windows(recording(most_ceres_windows), o);
  EXPECT_EQ(few.count(), most_ceres_windows);
  EXPECT_EQ(test::by_batch(few), 0);
  const WindowFits many = fit_windows(recording(most_ceres_windows + 1), o);
  EXPECT_EQ(many.count(), most_ceres_windows + 1);
  EXPECT_GT(test::by_batch(many), most_ceres_windows * 99 / 100);
}

TEST(WindowSolverAuto, CountsSolutionsNotAttempts) {
  std::mt19937_64 generator(5);
  Trajectory run = test::gaussian_run(test::skid_structure, test::skid_theta, 0.05, 150, generator);
  run.state.middleCols(0, 40).setConstant(std::nan(""));  // windows without any transition
  for (const WindowSolver solver : {WindowSolver::ceres, WindowSolver::batch}) {
    FitOptions o;
    o.solver = solver;
    const WindowFits fits = fit_windows(test::make_recording({run}), o);
    const Index failed = (fits.status.array() == static_cast<int>(FitStatus::failed)).count();
    EXPECT_GT(failed, 0);
    EXPECT_LE(test::by_batch(fits), fits.count() - failed);
    EXPECT_EQ(test::by_batch(fits) > 0, solver == WindowSolver::batch);
  }
}

TEST(StreamedWindows, AreTheSameAsCollectedOnes) {
  const Recording recording = hard_recording(test::skid_structure, 200, true);
  FitOptions o;
  o.solver = WindowSolver::batch;
  const WindowFits whole = fit_windows(recording, o);
  Index seen = 0;
  const WindowFits common = stream_windows(recording, o, [&](const WindowFits& chunk, Index first) {
    EXPECT_EQ(first, seen);
    EXPECT_TRUE(test::same_bits(chunk.parameters, whole.parameters.middleCols(first, chunk.count())));
    seen += chunk.count();
  });
  EXPECT_EQ(seen, whole.count());
  EXPECT_EQ(count_windows(recording, {}), whole.count());
  EXPECT_TRUE(test::same_bits(common.prior_sd, whole.prior_sd));
}

}  // namespace
}  // namespace modebank
