// Clouds of one-lag fits of windows with many lags, and the banks learned from them.
#include "filter/learn/from_mixture/cluster_windows.hpp"

#include <gmock/gmock.h>

#include <boost/random/normal_distribution.hpp>
#include <random>

#include "filter/learn/from_mixture/memberships.hpp"
#include "filter/learn/from_mixture/pooled_modes.hpp"
#include "ident/fit/fit_windows.hpp"
#include "modebank/base/error.hpp"
#include "tests/filter/learn/learn_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using test::near;
using ::testing::ElementsAre;

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
  explicit Clustered(const ClusterOptions& options, const FitOptions& window = many_lags())
      : fits(fit_windows(recording, window)), mixture(cluster_windows(recording, fits, window, options, 1)) {}
};

ClusterOptions two_components(CovarianceType covariance) {
  ClusterOptions options;
  options.selection.components = {2};
  options.selection.em.covariance = covariance;
  return options;
}

TEST(ClusterWindows, OfManyLagsAreThoseOfOneLagFits) {
  for (const CovarianceType covariance : {CovarianceType::full, CovarianceType::diagonal}) {
    const Clustered c(two_components(covariance));
    EXPECT_THAT(c.mixture.feature_names, ElementsAre("A", "B1", "B2", "log_noise_variance_x0"));
    ASSERT_EQ(c.mixture.features.cols(), c.fits.count());
    EXPECT_TRUE(near(c.mixture.features.topRows(3), fit_one_lag(c.recording, c.fits, many_lags()).parameters, 0.0));
    for (Index k = 0; k < 2; ++k) {
      const bool second = c.mixture.mixture.means(0, k) < -0.4;
      EXPECT_NEAR(c.mixture.mixture.means(0, k), second ? -0.6 : -0.2, 0.02) << "A is the increment's";
      EXPECT_NEAR(c.mixture.mixture.means(2, k), second ? 0.6 : 0.2, 0.02);
    }
    for (Index i = 0; i < c.fits.count(); ++i)
      EXPECT_EQ(c.mixture.labels(i) >= 0 && c.mixture.mixture.means(0, c.mixture.labels(i)) < -0.4,
                c.fits.windows[static_cast<std::size_t>(i)].run % 2 == 1);
  }
}

/// A mode's coefficients are the pooled regression of its runs with all lags. Its parameter covariance is that of its
/// windows.
TEST(ClusterWindows, StartModesOfAllCoefficients) {
  const Clustered c(two_components(CovarianceType::full));
  BankOptions options;
  options.refine = Refine::none;
  const Bank bank = learn_bank(c.recording, c.fits, c.mixture, options, Eigen::MatrixXd::Constant(1, 1, 1e-4));
  ASSERT_EQ(bank.mode_count(), 2);
  const TrainingTransitions transitions = gather_training_transitions(c.recording, c.fits.structure);
  const Eigen::MatrixXd memberships = transition_memberships(transitions, c.fits, c.mixture);
  const ParameterPrior prior{c.fits.global.theta, c.fits.prior_sd};
  for (Index k = 0; k < 2; ++k) {
    const ModeEstimate pooled = fit_weighted_mode(transitions, memberships.col(k), c.fits.global, &prior);
    EXPECT_TRUE(near(bank.theta(k), pooled.theta, 1e-12));
    EXPECT_EQ(bank.theta(k).size(), 24);
    std::vector<Index> own;
    for (Index i = 0; i < c.fits.count(); ++i)
      if (c.mixture.labels(i) == k) own.push_back(i);
    const Eigen::MatrixXd theta = c.fits.parameters(Eigen::all, own);
    const Eigen::MatrixXd offset = theta.colwise() - theta.rowwise().mean();
    const Eigen::VectorXd variance = offset.rowwise().squaredNorm() / static_cast<double>(own.size());
    EXPECT_TRUE(near(bank.modes[static_cast<std::size_t>(k)].parameter_covariance.diagonal(), variance, 1e-6))
        << "memberships are all but certain";
  }
}

TEST(ClusterWindows, MeansOfOtherFeaturesAreNoModes) {
  const Clustered c(two_components(CovarianceType::full));
  BankOptions options;
  options.theta = ThetaSource::mean;
  EXPECT_THROW(learn_bank(c.recording, c.fits, c.mixture, options, Eigen::MatrixXd::Identity(1, 1)),
               ConfigurationError);
}

TEST(ClusterWindows, OfFewCoefficientsAreTheirOwn) {
  FitOptions window;
  const Clustered c(two_components(CovarianceType::full), window);
  EXPECT_EQ(c.mixture.features.size(), 0);
  EXPECT_EQ(c.mixture.feature_names, (std::vector<std::string>{"A", "B1", "B2", "log_noise_variance_x0"}));
}

TEST(ClusterWindows, AllCoefficientsAreClusteredWhereTheyAreAskedFor) {
  ClusterOptions options = two_components(CovarianceType::diagonal);
  options.features = FeatureSet::parameters_and_noise;
  const Clustered c(options);
  EXPECT_EQ(c.mixture.features.size(), 0);
  EXPECT_EQ(c.mixture.feature_names.size(), 25u);
}

}  // namespace
}  // namespace modebank
