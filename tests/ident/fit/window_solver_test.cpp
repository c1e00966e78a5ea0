// The number of windows that each solver solves, and the audit.
#include <gtest/gtest.h>

#include "ident/fit/audit.hpp"
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
  EXPECT_EQ(fit_windows(recording, o).audit.batch, 0);
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
  EXPECT_EQ(few.audit.ceres, most_ceres_windows);
  EXPECT_EQ(few.audit.batch, 0);
  EXPECT_EQ(few.audit.checked, 0);
  EXPECT_EQ(few.audit.ceres_method, "Ceres, then Newton's method to a relative gradient of 1e-10");
  EXPECT_EQ(few.audit.batch_method, "");
  const WindowFits many = fit_windows(recording(most_ceres_windows + 1), o);
  EXPECT_EQ(many.audit.batch + many.audit.ceres, most_ceres_windows + 1);
  EXPECT_GT(many.audit.batch, most_ceres_windows * 99 / 100);
  EXPECT_EQ(many.audit.checked, 200);
  EXPECT_EQ(many.audit.replaced, 0);
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
    EXPECT_EQ(fits.audit.batch + fits.audit.ceres, fits.count() - failed);
    EXPECT_EQ(fits.audit.batch > 0, solver == WindowSolver::batch);
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
  EXPECT_EQ(common.audit.checked, whole.audit.checked);
  EXPECT_TRUE(test::same_bits(common.prior_sd, whole.prior_sd));
}

TEST(WindowAudits, SampleEveryPartAndRejectAWorseSolution) {
  EXPECT_EQ(audited_windows(50, 1).size(), 50U);
  const std::vector<Index> sample = audited_windows(1000000, 7);
  EXPECT_EQ(sample.size(), 1000U);
  EXPECT_TRUE(std::is_sorted(sample.begin(), sample.end()));
  EXPECT_NE(sample, audited_windows(1000000, 8));

  const Recording recording = hard_recording(test::skid_structure, 100, false);
  const WindowFits fits = fit_windows(recording, {});
  const FitOptions options;
  const LinearWindows context(recording, options, test::skid_structure, fits.global);
  const ParameterPrior prior{fits.global.theta, fits.prior_sd};
  LocalModel wrong = fits.at(0);
  wrong.theta(0) += 1e-3;
  WindowAudit audit;
  EXPECT_FALSE(add_to_audit(audit_window(context, fits.windows[0], &prior, fits.at(0)), audit));
  EXPECT_EQ(audit.replaced, 0);
  EXPECT_TRUE(add_to_audit(audit_window(context, fits.windows[0], &prior, wrong), audit));
  EXPECT_EQ(audit.replaced, 1);
  EXPECT_GT(audit.cost_difference, WindowAudit::tolerance);
  EXPECT_GT(audit.gradient, WindowAudit::gradient_tolerance);
}

}  // namespace
}  // namespace modebank
