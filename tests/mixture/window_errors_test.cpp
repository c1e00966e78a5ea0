// Windows of unequal excitation, and the effect of their covariances on the mixture of their parameters.
#include <gtest/gtest.h>

#include "ident/base/not_a_number.hpp"
#include "ident/fit/fit_windows.hpp"
#include "mixture/select.hpp"
#include "mixture/window_error.hpp"
#include "tests/mixture/mixture_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank::test {
namespace {

using Eigen::Index;

constexpr Index window_length = 25;

/// Runs with the length of one window. The parameters of each run are drawn from one of two modes. The inputs of each
/// run have their own amplitude, log-uniform from 0.03 to 1.
struct WindowRuns {
  GaussianMixture truth;
  Recording recording;

  explicit WindowRuns(Index count) {
    truth.weights = Eigen::Vector2d(0.7, 0.3);
    truth.means = (Eigen::MatrixXd(3, 2) << -0.5, -0.5, -0.45, -0.3, 0.45, 0.3).finished();
    const Eigen::Matrix3d spread = (Eigen::Matrix3d() << 4e-4, 0.0, 0.0, 0.0, 9e-4, -3e-4, 0.0, -3e-4, 9e-4).finished();
    truth.covariances = {spread, spread};
    recording.states = {{"x", ""}};
    recording.inputs = {{"left", ""}, {"right", ""}};
    std::mt19937_64 generator(21);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform(std::log(0.03), 0.0);
    const Eigen::MatrixXd theta = sample(truth, count, generator);
    for (Index i = 0; i < count; ++i) {
      Trajectory run;
      run.run = std::to_string(i);
      run.role = Role::train;
      const double amplitude = std::exp(uniform(generator));
      run.input = Eigen::MatrixXd::NullaryExpr(2, window_length + 1, [&] { return amplitude * normal(generator); });
      run.state.resize(1, window_length + 1);
      run.time_s = Eigen::VectorXd::LinSpaced(window_length + 1, 0.0, static_cast<double>(window_length));
      double x = 0.0;
      for (Index k = 0; k <= window_length; ++k) {
        run.state(0, k) = x;
        x += theta(0, i) * x + theta(1, i) * run.input(0, k) + theta(2, i) * run.input(1, k) + 0.03 * normal(generator);
      }
      recording.runs.push_back(run);
    }
  }

  WindowFits fits(Prior prior, double prior_sd = 0.0) const {
    FitOptions options;
    if (prior_sd > 0.0) options.prior_sd = {prior_sd};
    options.length = window_length;
    options.loss = Loss::trivial;
    options.prior = prior;
    return fit_windows(recording, options);
  }
};

FeatureCloud cloud_with(const WindowFits& fits, WindowErrors errors) {
  return make_features(fits, FeatureSet::parameters, WindowChoice::all, {{"x", ""}}, WindowsOverSwitch::keep, errors);
}

/// Errors of the components' means and standard deviations.
struct Misfit {
  double mean;       ///< largest error of a mean, in standard deviations of its component
  double inflation;  ///< largest ratio of the input parameters' standard deviation to the true one
};

Misfit misfit(const GaussianMixture& fit, const GaussianMixture& truth) {
  Misfit result{0.0, 0.0};
  for (Index k = 0; k < 2; ++k) {
    const Eigen::MatrixXd& spread = truth.covariances[k];
    const Eigen::ArrayXd off = (fit.means.col(k) - truth.means.col(k)).array() / spread.diagonal().array().sqrt();
    result.mean = std::max(result.mean, off.abs().tail(2).maxCoeff());
    const double trace = fit.covariances[k].bottomRightCorner(2, 2).trace();
    result.inflation = std::max(result.inflation, trace / spread.bottomRightCorner(2, 2).trace());
  }
  return result;
}

TEST(WindowErrors, RecoverModesOfUnequallyExcitedWindows) {
  const WindowRuns stretches(1500);
  for (const Prior prior : {Prior::none, Prior::global}) {
    const WindowFits fits = stretches.fits(prior);
    const FeatureCloud plain = cloud_with(fits, WindowErrors::ignore), aware = cloud_with(fits, WindowErrors::include);
    EXPECT_EQ(plain.covariances.size(), 0);
    const Misfit blurred = misfit(fit_em(plain.point_set(), 2, EmOptions(), 1).mixture, stretches.truth);
    const Misfit recovered = misfit(fit_em(aware.point_set(), 2, EmOptions(), 1).mixture, stretches.truth);
    EXPECT_LT(recovered.mean, 0.35);
    EXPECT_LT(std::abs(recovered.inflation - 1.0), 0.4);
    EXPECT_GT(blurred.mean, 0.7) << "the comparison shows nothing";
    EXPECT_GT(blurred.inflation, 2.5) << "the comparison shows nothing";
  }
}

TEST(WindowErrors, ThePriorIsTakenOffAgain) {
  const WindowRuns stretches(100);
  const WindowFits free = stretches.fits(Prior::none), held = stretches.fits(Prior::global, 0.1);
  const FeatureCloud a = cloud_with(free, WindowErrors::include), b = cloud_with(held, WindowErrors::include);
  ASSERT_EQ(a.points.cols(), b.points.cols());
  double pull = 0.0, left = 0.0;  // sums of squares, in units of standard errors
  for (Index i = 0; i < a.points.cols(); ++i) {
    // if data have less information, the prior is not removed completely
    if (held.information.col(i).minCoeff() < 0.3) continue;
    const Eigen::ArrayXd sd = a.covariances.col(i).reshaped(3, 3).diagonal().array().sqrt();
    pull += ((a.points.col(i) - held.parameters.col(i)).array() / sd).square().sum();
    left += ((a.points.col(i) - b.points.col(i)).array() / sd).square().sum();
  }
  EXPECT_GT(pull, 10.0);
  EXPECT_LT(left, 1e-16 * pull);
}

/// Robust losses weight samples by their residuals, which depend on the prior's pull. Only the mean weight is known.
TEST(WindowErrors, ThePriorIsTakenOffOfRobustFits) {
  const WindowRuns stretches(100);
  FitOptions options;
  options.length = window_length;
  options.prior = Prior::none;
  const WindowFits free = fit_windows(stretches.recording, options);
  options.prior = Prior::global;
  options.prior_sd = {0.1};
  const WindowFits held = fit_windows(stretches.recording, options);
  WindowFits alike = held;  // the result if the data had the same information in the fit and in the covariance
  alike.weighed_information.setOnes();
  const FeatureCloud a = cloud_with(free, WindowErrors::include), b = cloud_with(held, WindowErrors::include),
                     c = cloud_with(alike, WindowErrors::include);
  double pull = 0.0, left = 0.0, left_alike = 0.0;
  for (Index i = 0; i < a.points.cols(); ++i) {
    if (held.information.col(i).minCoeff() < 0.3) continue;
    const Eigen::ArrayXd sd = a.covariances.col(i).reshaped(3, 3).diagonal().array().sqrt();
    const auto distance = [&](const auto& theta) { return ((a.points.col(i) - theta).array() / sd).square().sum(); };
    pull += distance(held.parameters.col(i));
    left += distance(b.points.col(i));
    left_alike += distance(c.points.col(i));
  }
  EXPECT_GT(pull, 10.0);
  EXPECT_LT(left, 0.06 * pull);
  EXPECT_LT(left, 0.5 * left_alike);
}

/// Closed form for two states with one parameter each. The data have information d_i, multiplied by s_i in the fit. The
/// prior pulls the data's estimate y_i towards its mean, to s_i d_i / (1 + s_i d_i) y_i.
TEST(WindowErrors, ThePriorIsTakenOffStateByState) {
  WindowFits fits;
  fits.structure = LinearStructure{2, 0, false};
  fits.prior_sd = Eigen::Vector4d(0.5, 1.0, 2.0, 4.0);
  fits.global.theta = Eigen::Vector4d(0.1, 0.2, 0.3, 0.4);
  fits.weighed_information = (Eigen::MatrixXd(2, 1) << 0.6, 1.7).finished();
  const Eigen::Array4d information(0.2, 3.0, 40.0, 1.0), said(1.0, -2.0, 3.0, 0.5);
  const Eigen::Array4d weighed = information * Eigen::Array4d(0.6, 0.6, 1.7, 1.7), sd = fits.prior_sd.array();
  Eigen::VectorXd theta = fits.global.theta.array() + sd * said * weighed / (1.0 + weighed);
  Eigen::MatrixXd covariance = (sd.square() / (1.0 + information)).matrix().asDiagonal();
  take_off_prior(fits, 0, theta, covariance);
  EXPECT_TRUE(near(theta, Eigen::VectorXd((fits.global.theta.array() + sd * said).matrix()), 1e-12));
  EXPECT_TRUE(near(covariance, Eigen::MatrixXd((sd.square() / information).matrix().asDiagonal()), 1e-12));
}

TEST(WindowErrors, OfASandwichNothingIsTakenOff) {
  const WindowRuns stretches(20);
  FitOptions options;
  options.length = window_length;
  options.covariance = CovarianceKind::sandwich;
  const WindowFits fits = fit_windows(stretches.recording, options);
  EXPECT_FALSE(prior_comes_off(fits, 0));
  EXPECT_TRUE(cloud_with(fits, WindowErrors::include).windows.empty());
}

TEST(WindowErrors, LogVarianceAndUnknownCovariances) {
  WindowFits fits;
  fits.structure = LinearStructure{1, 2, false};
  fits.length = 25;
  fits.windows = {{0, 0}, {0, 1}, {0, 2}};
  fits.parameters = Eigen::MatrixXd::Constant(3, 3, 0.5);
  fits.noise_variance = Eigen::MatrixXd::Constant(1, 3, 0.01);
  fits.covariance = Eigen::Matrix3d::Identity().eval().reshaped(9, 1).replicate(1, 3);
  fits.covariance(4, 1) = not_a_number;
  fits.rank = (Eigen::VectorXi(3) << 3, 2, 3).finished();
  fits.status = (Eigen::VectorXi(3) << 0, 2, 0).finished();
  const auto make = [&](WindowErrors errors) {
    return make_features(fits, FeatureSet::parameters_and_noise, WindowChoice::all, {{"x", ""}},
                         WindowsOverSwitch::keep, errors);
  };
  EXPECT_EQ(make(WindowErrors::ignore).windows.size(), 3u);
  const FeatureCloud cloud = make(WindowErrors::include);
  EXPECT_EQ(cloud.windows, (std::vector<Index>{0, 2}));
  Eigen::Matrix4d expected = Eigen::Matrix4d::Identity();
  expected(3, 3) = 2.0 / 22.0;
  EXPECT_TRUE(near(cloud.covariances.col(0).reshaped(4, 4), expected, 1e-15));
}

}  // namespace
}  // namespace modebank::test
