// Banks from mixtures: laws, sources of theta, Q, R and T, and screening.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "modebank/base/error.hpp"
#include "tests/filter/learn/learn_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using test::near;

constexpr double bank_exact = 1e-10;
const Eigen::MatrixXd R_given = Eigen::MatrixXd::Constant(1, 1, 1e-4);

/// Runs of 40 transitions, each in one mode of x[k+1] = x + a x + 0.5 u + 0.1 w, and a held-out run that must be
/// ignored.
Recording runs_in_modes(const std::vector<double>& a) {
  Index run = -1;
  Recording recording =
      test::simulated_runs(std::ssize(a), 41, 9, [&](const auto& x, const auto& u, Index k, double w) {
        if (k == 0) ++run;
        return x(k) + a[run] * x(k) + 0.5 * u(k) + 0.1 * w;
      });
  test::add_run(recording, Eigen::MatrixXd::Constant(1, 10, 100.0), Eigen::MatrixXd::Zero(1, 10), Role::test);
  recording.runs.back().time_s *= 50.0;
  return recording;
}

/// Memberships where windows of run i belong to component i alone.
Eigen::MatrixXd memberships_by_run(const WindowFits& fits, Index components) {
  Eigen::MatrixXd gamma = Eigen::MatrixXd::Zero(components, fits.count());
  for (Index i = 0; i < fits.count(); ++i) gamma(fits.windows[i].run, i) = 1.0;
  return gamma;
}

struct Case {
  Recording recording;
  WindowFits fits;
  MixtureResult mixture;
  explicit Case(const std::vector<double>& a, Index step = 1)
      : recording(runs_in_modes(a)),
        fits(test::windows_of(recording, 10, step)),
        mixture(test::mixture_of(fits, memberships_by_run(fits, std::ssize(a)))) {}
  Bank learn(const BankOptions& options = {}) const { return learn_bank(recording, fits, mixture, options, R_given); }
  GlobalModel alone(Index run) const {
    Recording one{recording.states, recording.inputs, {recording.runs[run]}};
    return fit_global(one, fits.structure);
  }
};

TEST(LearnBank, EachModeIsTheRegressionOfItsRun) {
  const Case data({-0.2, -0.5, -0.8});
  const Bank bank = data.learn();
  ASSERT_EQ(bank.mode_count(), 3);
  for (Index j = 0; j < 3; ++j) {
    const GlobalModel alone = data.alone(j);
    EXPECT_TRUE(near(bank.theta(j), alone.theta, bank_exact));
    EXPECT_TRUE(near(bank.modes[j].Q, alone.residual_covariance, bank_exact));
    EXPECT_TRUE(near(bank.modes[j].standard_error, alone.covariance.diagonal().cwiseSqrt(), bank_exact));
    EXPECT_TRUE(near(bank.modes[j].parameter_covariance, data.mixture.mixture.covariances[j], 0.0));
    EXPECT_NEAR(bank.modes[j].weight, 1.0 / 3.0, bank_exact);
  }
  EXPECT_NO_THROW(check_sizes(bank));
  EXPECT_TRUE(near(bank.R, R_given, 0.0));
  EXPECT_TRUE(near(bank.initial_probability, Eigen::Vector3d::Constant(1.0 / 3.0), bank_exact));
  EXPECT_THAT(bank.state_names, testing::ElementsAre("x0"));
  EXPECT_THAT(bank.input_names, testing::ElementsAre("u0"));
  EXPECT_NEAR(bank.dt_s, 0.1, bank_exact) << "of the training runs";
  EXPECT_TRUE(bank.screened.empty());
}

TEST(LearnBank, MeanTakesTheComponentsMeansAndNoiseAboutThem) {
  Case data({-0.2, -0.8});
  data.mixture.mixture.means << -0.25, -0.75, 0.4, 0.6;
  BankOptions options;
  options.theta = ThetaSource::mean;
  const Bank bank = data.learn(options);
  for (Index j = 0; j < 2; ++j) {
    EXPECT_TRUE(near(bank.theta(j), data.mixture.mixture.means.col(j), 0.0));
    const Trajectory& run = data.recording.runs[j];
    double sum = 0.0;
    for (Index k = 0; k < 40; ++k)
      sum += std::pow(run.state(k + 1) - bank.modes[j].model.next(run.state.col(k), run.input.col(k))(0), 2);
    EXPECT_NEAR(bank.modes[j].Q(0, 0), sum / 40.0, bank_exact);
  }
}

/// By default linear modes are refined, unless refinement would undo an option that the user has set.
TEST(LearnBank, RefinementIsTheDefaultOfWhatItDoesNotUndo) {
  BankOptions options, mean, fixed, stay;
  EXPECT_EQ(refinement_asked(options, true), Refine::em);
  EXPECT_EQ(refinement_asked(options, false), Refine::none);
  options.refine = Refine::em;
  EXPECT_EQ(refinement_asked(options, false), Refine::em);
  mean.theta = ThetaSource::mean;
  fixed.process_variance = 0.01;
  stay.transition = TransitionSource::stay;
  for (const BankOptions& kept : {mean, fixed, stay}) EXPECT_EQ(refinement_asked(kept, true), Refine::none);
}

TEST(LearnBank, NoiseAndTransitionsMayBeGiven) {
  const Case data({-0.2, -0.8}, 2);  // 16 windows in each run give 15 pairs
  const double stay = std::sqrt(15.1 / 15.2);
  const Bank own = data.learn();
  EXPECT_TRUE(near(own.transition.matrix(), Eigen::Matrix2d{{stay, 1 - stay}, {1 - stay, stay}}, bank_exact));
  BankOptions options;
  options.process_variance = 0.02;
  options.measurement_variance = 0.03;
  options.transition = TransitionSource::stay;
  options.stay = 0.9;
  const Bank fixed = data.learn(options);
  for (Index j = 0; j < 2; ++j) {
    EXPECT_EQ(fixed.modes[j].Q(0, 0), 0.02);
    EXPECT_TRUE(near(fixed.theta(j), own.theta(j), 0.0));
  }
  EXPECT_EQ(fixed.R(0, 0), 0.03);
  EXPECT_TRUE(near(fixed.transition.matrix(), Eigen::Matrix2d{{0.9, 0.1}, {0.1, 0.9}}, bank_exact));
}

TEST(Screening, UnstableAndStarvedModesAreListedAndLeftOut) {
  Case data({-0.2, 0.1, -0.8});  // the second mode grows by a tenth per step
  Eigen::MatrixXd gamma = Eigen::MatrixXd::Zero(4, data.fits.count());
  gamma.topRows(3) = memberships_by_run(data.fits, 3);
  gamma.col(0) << 0.9, 0.0, 0.0, 0.1;  // a tenth of one transition, plus parts of nine others
  data.mixture = test::mixture_of(data.fits, gamma);
  data.mixture.mixture.weights << 0.4, 0.04, 0.46, 0.1;
  const Bank bank = data.learn();
  ASSERT_EQ(bank.mode_count(), 2);
  EXPECT_NEAR(bank.modes[0].weight, 0.4 / 0.86, bank_exact);
  EXPECT_NEAR(bank.modes[1].weight, 0.46 / 0.86, bank_exact);
  EXPECT_TRUE(near(bank.theta(1), data.alone(2).theta, bank_exact));
  EXPECT_EQ(bank.transition.modes(), 2);
  ASSERT_EQ(bank.screened.size(), 2);
  EXPECT_EQ(bank.screened[0].component, 1);
  EXPECT_EQ(bank.screened[0].reason, "unstable") << "used for less than 5 %";
  EXPECT_EQ(bank.screened[0].weight, 0.04);
  EXPECT_NEAR(bank.screened[0].spectral_radius, 1.0 + data.alone(1).theta(0), bank_exact);
  EXPECT_EQ(bank.screened[1].component, 3);
  EXPECT_EQ(bank.screened[1].reason, "starved");
  BankOptions keep;
  keep.screen = false;
  const Bank all = data.learn(keep);
  EXPECT_EQ(all.mode_count(), 4);
  EXPECT_TRUE(all.screened.empty());
}

/// A loop may bound the data of an unstable mode: left-out scores judge it.
TEST(Screening, UnstableModesThatAreUsedStay) {
  Case data({-0.2, -0.3});
  BankOptions options;
  options.theta = ThetaSource::mean;
  data.mixture.mixture.means.row(0) << 0.4, 0.3;
  const Bank bank = data.learn(options);
  ASSERT_EQ(bank.mode_count(), 2);
  EXPECT_EQ(bank.theta(0)(0), 0.4);
  EXPECT_TRUE(bank.screened.empty());
}

TEST(LearnBank, BadArgumentsAreRefused) {
  Case data({-0.2, -0.3});
  BankOptions options;
  options.measurement_variance = -1.0;
  EXPECT_THROW(data.learn(options), std::invalid_argument);
  EXPECT_THROW(learn_bank(data.recording, data.fits, data.mixture, {}, Eigen::MatrixXd::Identity(2, 2)),
               std::invalid_argument);
  MixtureResult foreign = data.mixture;
  foreign.responsibilities = Eigen::MatrixXd(Eigen::MatrixXd::Constant(2, data.fits.count() - 1, 0.5));
  EXPECT_THROW(learn_bank(data.recording, data.fits, foreign, {}, R_given), std::invalid_argument);
  data.fits.structure.inputs = 2;
  EXPECT_THROW(data.learn(), std::invalid_argument);
}

/// Counts: 0->0 and 0->1 (component 2). Windows 4 and 8 have a gap between them. Then a new run begins. Windows without
/// a mode, and one of component 1, which is not kept, count as the previous mode: 1->1 three times; 1->0.
TEST(LabelTransitions, CountsNeighboursWithinRuns) {
  WindowFits fits;
  fits.step = 2;
  fits.windows = {{0, 0}, {0, 2}, {0, 4}, {0, 8}, {1, 0}, {1, 2}, {1, 4}, {1, 6}, {1, 8}};
  const Eigen::VectorXi labels{{0, 0, 2, 2, 2, -1, 1, 2, 0}};
  EXPECT_EQ(count_label_transitions(fits, labels, {0, 2}), (Eigen::MatrixXd{{1, 1}, {1, 3}}));
}

TEST(TransitionFromCounts, SmoothsByATenthAndTakesTheRootOfTheDiagonal) {
  constexpr double row_rounding = 1e-14;  // of a few divisions
  const double stay0 = std::cbrt(0.8), stay1 = std::cbrt(4.0 / 6.0), stay2 = std::cbrt(1.0 / 3.0);
  const Eigen::MatrixXd expected{{stay0, (1 - stay0) / 2, (1 - stay0) / 2},
                                 {(1 - stay1) / 4, stay1, (1 - stay1) * 3 / 4},
                                 {(1 - stay2) / 2, (1 - stay2) / 2, stay2}};
  EXPECT_TRUE(near(transition_from_counts(Eigen::MatrixXd{{7.9, 0.9, 0.9}, {0.4, 3.9, 1.4}, {0, 0, 0}}, 3).matrix(),
                   expected, row_rounding));
  EXPECT_TRUE(near(transition_from_counts(Eigen::MatrixXd{{5.0}}, 4).matrix(), Eigen::MatrixXd::Ones(1, 1), 0.0));
}

}  // namespace
}  // namespace modebank
