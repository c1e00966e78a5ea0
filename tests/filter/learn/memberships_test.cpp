// Each transition counts once, with the mean responsibility of the windows that cover it.
#include "filter/learn/from_mixture/memberships.hpp"

#include <gtest/gtest.h>

#include "ident/base/not_a_number.hpp"
#include "tests/filter/learn/learn_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using test::near;

/// Rounding error of a mean of at most two responsibilities.
constexpr double weight_rounding = 1e-15;

Recording two_runs(Index first, Index second) {
  Recording recording = test::empty_recording(1, 0);
  for (const Index transitions : {first, second}) {
    Eigen::MatrixXd state = Eigen::VectorXd::LinSpaced(transitions + 1, 1.0, 2.0).array().square().matrix().transpose();
    test::add_run(recording, state, Eigen::MatrixXd(0, transitions + 1));
  }
  return recording;
}

TEST(Memberships, AreMeansOfCoveringWindowsByHand) {
  const Recording recording = two_runs(4, 2);
  const WindowFits fits = test::windows_of(recording, 3, 1);  // two windows in the first run, none in the second
  Eigen::MatrixXd gamma(2, 2);
  gamma << 1.0, 0.2, 0.0, 0.8;
  const TrainingTransitions transitions = gather_training_transitions(recording, fits.structure);
  MixtureResult mixture = test::mixture_of(fits, gamma);
  mixture.mixture.weights << 0.7, 0.3;
  Eigen::MatrixXd expected(6, 2);
  expected << 1.0, 0.0, 0.6, 0.4, 0.6, 0.4, 0.2, 0.8, 0.7, 0.3, 0.7, 0.3;
  EXPECT_TRUE(near(transition_memberships(transitions, fits, mixture), expected, weight_rounding));
}

TEST(Memberships, UncoveredTransitionsTakeTheNearestClusteredWindow) {
  const Recording recording = two_runs(12, 1);
  const WindowFits fits = test::windows_of(recording, 2, 1);  // starts 0 .. 10
  Eigen::MatrixXd gamma = Eigen::MatrixXd::Constant(2, fits.count(), not_a_number);
  gamma.col(2) << 1.0, 0.0;  // covers transitions 2 and 3
  gamma.col(8) << 0.0, 1.0;  // covers transitions 8 and 9
  const TrainingTransitions transitions = gather_training_transitions(recording, fits.structure);
  const Eigen::MatrixXd g = transition_memberships(transitions, fits, test::mixture_of(fits, gamma));
  Eigen::VectorXd first(13);  // transition 5 is two from the first window and 6 is two from the second; 12 is in the
                              // other run
  first << 1, 1, 1, 1, 1, 1, 0, 0, 0, 0, 0, 0, 0.5;
  EXPECT_TRUE(near(g.col(0), first, weight_rounding));
  EXPECT_TRUE(near(g.rowwise().sum(), Eigen::VectorXd::Ones(13), weight_rounding));
}

TEST(Memberships, MissingSamplesBelongToNoMode) {
  Recording recording = two_runs(5, 3);
  const WindowFits fits = test::windows_of(recording, 3, 1);
  recording.runs[0].state(0, 2) = not_a_number;  // makes transitions 1 and 2 unusable
  const TrainingTransitions transitions = gather_training_transitions(recording, fits.structure);
  const Eigen::MatrixXd gamma = Eigen::MatrixXd::Constant(2, fits.count(), 0.5);
  const Eigen::MatrixXd g = transition_memberships(transitions, fits, test::mixture_of(fits, gamma));
  Eigen::VectorXd expected = Eigen::VectorXd::Ones(8);
  expected.segment(1, 2).setZero();
  EXPECT_TRUE(near(g.rowwise().sum(), expected, weight_rounding));
}

TEST(Memberships, NoiseTeachesNoMode) {
  const Recording recording = two_runs(5, 3);
  const WindowFits fits = test::windows_of(recording, 3, 1);
  Eigen::MatrixXd gamma = Eigen::MatrixXd::Constant(2, fits.count(), 0.5);
  gamma.col(fits.count() - 1) << 0.06, 0.02;  // the second run has one window, which is noise with probability 0.92
  MixtureResult mixture = test::mixture_of(fits, gamma);
  mixture.mixture.noise = {0.1, -Eigen::VectorXd::Ones(3), Eigen::VectorXd::Ones(3)};
  mixture.mixture.weights *= 0.9;
  mixture.labels(fits.count() - 1) = -1;
  const TrainingTransitions transitions = gather_training_transitions(recording, fits.structure);
  const Eigen::MatrixXd g = transition_memberships(transitions, fits, mixture);
  EXPECT_TRUE(near(g.topRows(5).rowwise().sum(), Eigen::VectorXd::Ones(5), weight_rounding));
  EXPECT_TRUE(near(g.bottomRows(3), Eigen::RowVector2d(0.06, 0.02).replicate(3, 1), weight_rounding));
}

TEST(Memberships, ForeignMixturesAreRefused) {
  const Recording recording = two_runs(5, 3);
  const WindowFits fits = test::windows_of(recording, 3, 1);
  MixtureResult mixture = test::mixture_of(fits, Eigen::MatrixXd::Constant(2, fits.count(), 0.5));
  mixture.responsibilities = Eigen::MatrixXd(Eigen::MatrixXd::Constant(2, fits.count() - 1, 0.5));
  EXPECT_THROW(transition_memberships(gather_training_transitions(recording, fits.structure), fits, mixture),
               std::invalid_argument);
}

}  // namespace
}  // namespace modebank
