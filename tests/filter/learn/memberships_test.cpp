// Each transition counts once, with the mean responsibility of the windows that cover it. Clouds of one-lag fits of
// windows with many lags, and the banks learned from them.
#include <gmock/gmock.h>

#include "filter/learn/from_mixture/pooled_modes.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/fit/fit_windows.hpp"
#include "modebank/base/error.hpp"
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

Eigen::MatrixXd memberships(const Recording& recording, const WindowFits& fits, const MixtureResult& mixture) {
  return transition_memberships(gather_training_transitions(recording, fits.structure), fits, mixture);
}

TEST(Memberships, AreMeansOfCoveringWindowsByHand) {
  const Recording recording = two_runs(4, 2);
  const WindowFits fits = test::windows_of(recording, 3, 1);  // two windows in the first run, none in the second
  MixtureResult mixture = test::mixture_of(fits, Eigen::Matrix2d{{1.0, 0.2}, {0.0, 0.8}});
  mixture.mixture.weights << 0.7, 0.3;
  Eigen::MatrixXd expected(6, 2);
  expected << 1.0, 0.0, 0.6, 0.4, 0.6, 0.4, 0.2, 0.8, 0.7, 0.3, 0.7, 0.3;
  EXPECT_TRUE(near(memberships(recording, fits, mixture), expected, weight_rounding));
}

/// Also where samples are missing: these transitions belong to no mode.
TEST(Memberships, UncoveredTransitionsTakeTheNearestClusteredWindow) {
  Recording recording = two_runs(12, 1);
  const WindowFits fits = test::windows_of(recording, 2, 1);  // starts 0 .. 10
  Eigen::MatrixXd gamma = Eigen::MatrixXd::Constant(2, fits.count(), not_a_number);
  gamma.col(2) << 1.0, 0.0;         // covers transitions 2 and 3
  gamma.col(8) << 0.0, 1.0;         // covers transitions 8 and 9
  Eigen::MatrixXd expected(13, 2);  // transition 5 is two from the first window and 6 is two from the second; 12 is in
                                    // the other run
  expected.col(0) << 1, 1, 1, 1, 1, 1, 0, 0, 0, 0, 0, 0, 0.5;
  expected.col(1) = 1.0 - expected.col(0).array();
  EXPECT_TRUE(near(memberships(recording, fits, test::mixture_of(fits, gamma)), expected, weight_rounding));
  recording.runs[0].state(0, 2) = not_a_number;  // makes transitions 1 and 2 unusable
  expected.middleRows(1, 2).setZero();
  EXPECT_TRUE(near(memberships(recording, fits, test::mixture_of(fits, gamma)), expected, weight_rounding));
}

TEST(Memberships, NoiseTeachesNoMode) {
  const Recording recording = two_runs(5, 3);
  const WindowFits fits = test::windows_of(recording, 3, 1);
  Eigen::MatrixXd gamma = Eigen::MatrixXd::Constant(2, fits.count(), 0.5);
  gamma.col(fits.count() - 1) << 0.06, 0.02;  // the second run has one window, which is noise with probability 0.92
  MixtureResult mixture = test::mixture_of(fits, gamma);
  mixture.mixture.noise = {0.1, -Eigen::VectorXd::Ones(3), Eigen::VectorXd::Ones(3)};
  const Eigen::MatrixXd g = memberships(recording, fits, mixture);
  EXPECT_TRUE(near(g.topRows(5).rowwise().sum(), Eigen::VectorXd::Ones(5), weight_rounding));
  EXPECT_TRUE(near(g.bottomRows(3), Eigen::RowVector2d(0.06, 0.02).replicate(3, 1), weight_rounding));
}

/// Six runs of 200 samples, alternating between two motions.
Recording runs_of_two_motions() {
  std::mt19937_64 generator(4);
  boost::random::normal_distribution<double> normal;
  Recording recording = test::empty_recording(1, 2);
  for (Index r = 0; r < 6; ++r) {
    const bool second = r % 2 == 1;
    Eigen::MatrixXd x = Eigen::MatrixXd::Zero(1, 200), u(2, 200);
    for (double& value : u.reshaped()) value = normal(generator);
    for (Index k = 0; k + 1 < x.cols(); ++k)
      x(k + 1) = (second ? 0.4 : 0.8) * x(k) + (second ? 0.6 : 0.2) * (u(1, k) - u(0, k)) + 0.05 * normal(generator);
    test::add_run(recording, x, u);
  }
  return recording;
}

FitOptions many_lags() {
  FitOptions window;
  window.model = "varx";
  window.state_lags = window.input_lags = 8;
  window.length = 72;
  window.step = 3;
  return window;
}

struct Clustered {
  Recording recording = runs_of_two_motions();
  WindowFits fits;
  MixtureResult mixture;
  explicit Clustered(CovarianceType covariance, const FitOptions& window = many_lags(), ClusterOptions options = {})
      : fits(fit_windows(recording, window)) {
    options.selection.components = {2};
    options.selection.em.covariance = covariance;
    mixture = cluster_windows(recording, fits, window, options, 1);
  }
};

TEST(ClusterWindows, OfManyLagsAreThoseOfOneLagFits) {
  for (const CovarianceType covariance : {CovarianceType::full, CovarianceType::diagonal}) {
    const Clustered c(covariance);
    const Eigen::MatrixXd& means = c.mixture.mixture.means;
    EXPECT_THAT(c.mixture.feature_names, ::testing::ElementsAre("A", "B1", "B2", "log_noise_variance_x0"));
    ASSERT_EQ(c.mixture.features.cols(), c.fits.count());
    EXPECT_TRUE(near(c.mixture.features.topRows(3), fit_one_lag(c.recording, c.fits, many_lags()).parameters, 0.0));
    for (Index k = 0; k < 2; ++k) {
      const bool second = means(0, k) < -0.4;
      EXPECT_NEAR(means(0, k), second ? -0.6 : -0.2, 0.02) << "A is the increment's";
      EXPECT_NEAR(means(2, k), second ? 0.6 : 0.2, 0.02);
    }
    for (Index i = 0; i < c.fits.count(); ++i)
      EXPECT_EQ(c.mixture.labels(i) >= 0 && means(0, c.mixture.labels(i)) < -0.4, c.fits.windows[i].run % 2 == 1);
  }
}

/// A mode's coefficients are the pooled regression of its runs with all lags. Its parameter covariance is that of its
/// windows.
TEST(ClusterWindows, StartModesOfAllCoefficients) {
  const Clustered c(CovarianceType::full);
  BankOptions options;
  options.refine = Refine::none;
  const Eigen::MatrixXd R = Eigen::MatrixXd::Constant(1, 1, 1e-4);
  const Bank bank = learn_bank(c.recording, c.fits, c.mixture, options, R);
  ASSERT_EQ(bank.mode_count(), 2);
  const Eigen::MatrixXd weights = memberships(c.recording, c.fits, c.mixture);
  const ParameterPrior prior{c.fits.global.theta, c.fits.prior_sd};
  for (Index k = 0; k < 2; ++k) {
    const ModeEstimate pooled = fit_weighted_mode(gather_training_transitions(c.recording, c.fits.structure),
                                                  weights.col(k), c.fits.global, &prior);
    EXPECT_TRUE(near(bank.theta(k), pooled.theta, 1e-12));
    EXPECT_EQ(bank.theta(k).size(), 24);
    std::vector<Index> own;  // memberships are all but certain
    for (Index i = 0; i < c.fits.count(); ++i)
      if (c.mixture.labels(i) == k) own.push_back(i);
    const Eigen::MatrixXd theta = c.fits.parameters(Eigen::all, own);
    const Eigen::MatrixXd offset = theta.colwise() - theta.rowwise().mean();
    const Eigen::VectorXd variance = offset.rowwise().squaredNorm() / static_cast<double>(own.size());
    EXPECT_TRUE(near(bank.modes[k].parameter_covariance.diagonal(), variance, 1e-6));
  }
  options.theta = ThetaSource::mean;  // the features are no parameters of these modes
  EXPECT_THROW(learn_bank(c.recording, c.fits, c.mixture, options, R), ConfigurationError);
}

TEST(ClusterWindows, CoefficientsAreTheirOwnWhereTheyAreFewOrAskedFor) {
  const Clustered few(CovarianceType::full, FitOptions());
  EXPECT_EQ(few.mixture.features.size(), 0);
  EXPECT_THAT(few.mixture.feature_names, ::testing::ElementsAre("A", "B1", "B2", "log_noise_variance_x0"));
  ClusterOptions all;
  all.features = FeatureSet::parameters_and_noise;
  const Clustered asked(CovarianceType::diagonal, many_lags(), all);
  EXPECT_EQ(asked.mixture.features.size(), 0);
  EXPECT_EQ(asked.mixture.feature_names.size(), 25u);
}

}  // namespace
}  // namespace modebank
