#include "ident/data/window.hpp"

#include "ident/base/seed.hpp"
#include "ident/fit/window_summary.hpp"
#include "ident/model/local_model.hpp"
#include "tests/ident/ident_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

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
    EXPECT_EQ(windows.window(i).run, expected[static_cast<std::size_t>(i)].first);
    EXPECT_EQ(windows.window(i).start, expected[static_cast<std::size_t>(i)].second);
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

TEST(WindowFits, GivesBackWhatWasSet) {
  WindowFits fits;
  fits.structure = {2, 1, false};
  fits.resize(3);
  LocalModel model;
  model.theta = Eigen::VectorXd::LinSpaced(6, 1, 6);
  model.covariance = 4.0 * Eigen::MatrixXd::Identity(6, 6);
  model.covariance(0, 5) = model.covariance(5, 0) = 0.5;
  model.noise_variance = Eigen::Vector2d(0.1, 0.2);
  model.condition = 7;
  model.rank = 4;
  model.information = Eigen::VectorXd::LinSpaced(6, 0, 1);
  model.inlier_fraction = 0.75;
  model.status = FitStatus::rank_deficient;
  model.r_squared = Eigen::Vector2d(0.8, 0.9);
  model.transitions = 24;
  fits.set(1, model);
  const LocalModel back = fits.at(1);
  EXPECT_EQ(fits.count(), 3);
  EXPECT_TRUE(test::near(back.theta, model.theta, 0));
  EXPECT_TRUE(test::near(back.covariance, model.covariance, 0));
  EXPECT_TRUE(test::near(back.noise_variance, model.noise_variance, 0));
  EXPECT_TRUE(test::near(back.information, model.information, 0));
  EXPECT_EQ(back.condition, model.condition);
  EXPECT_EQ(back.rank, model.rank);
  EXPECT_EQ(back.inlier_fraction, model.inlier_fraction);
  EXPECT_EQ(back.status, model.status);
  EXPECT_TRUE(test::near(back.r_squared, model.r_squared, 0));
  EXPECT_EQ(back.transitions, model.transitions);
  EXPECT_TRUE(test::near(fits.standard_errors().col(1), Eigen::VectorXd::Constant(6, 2.0), 0));
  EXPECT_TRUE(test::near(fits.t_values().col(1), model.theta / 2.0, 0));
}

TEST(WindowSummary, HoldsMediansOfWhatIsDefined) {
  WindowFits fits;
  fits.structure = {1, 0, false};
  fits.resize(4);
  fits.parameters << 1.0, -6.0, 3.0, 100.0;
  fits.covariance << 1.0, 4.0, 9.0, std::nan("");  // the t values are 1, -3, 1
  fits.r_squared << 0.2, 0.4, std::nan(""), 0.9;
  const WindowSummary summary = summarize(fits);
  EXPECT_EQ(summary.parameter(0), 2.0);
  EXPECT_EQ(summary.standard_error(0), 2.0);
  EXPECT_EQ(summary.significant(0), 1.0 / 3.0);
  EXPECT_EQ(summary.r_squared(0), 0.4);
  fits.covariance.setConstant(std::nan(""));
  EXPECT_TRUE(std::isnan(summarize(fits).significant(0)));
}

TEST(Seed, HasTheStatedMixing) {
  // These numbers are printed by tests/golden/generate/derive_seed.py.
  EXPECT_EQ(derive_seed(0, ""), 12014417281350144652ULL);
  EXPECT_EQ(derive_seed(1, "simulate.modes", 7), 4341455876973663748ULL);
}

TEST(Seed, UsesAndIndicesDiffer) {
  EXPECT_NE(derive_seed(1, "em", 0), derive_seed(1, "em", 1));
  EXPECT_NE(derive_seed(1, "em", 0), derive_seed(1, "me", 0));
  EXPECT_NE(derive_seed(1, "em", 0), derive_seed(2, "em", 0));
}

}  // namespace
}  // namespace modebank
