#include "ident/fit/prior.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "ident/fit/fit_window.hpp"
#include "ident/fit/fit_windows.hpp"
#include "modebank/base/error.hpp"
#include "tests/ident/ident_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::near;

constexpr double prior_rounding = 1e-11;

/// theta, sigma and prior of a small problem with one state and two inputs.
struct Example {
  LinearStructure structure{1, 2, false};
  VectorXd theta = Eigen::Vector3d(-0.3, -0.4, 0.5);
  ParameterPrior prior{Eigen::Vector3d(-0.2, -0.3, 0.3), Eigen::Vector3d(0.5, 0.2, 0.3)};
  double sigma = 0.1;
};

MatrixXd regressors(const Trajectory& run, Index start, Index L) {
  MatrixXd X(L, 3);
  X.col(0) = run.state.row(0).segment(start, L).transpose();
  X.rightCols(2) = run.input.middleCols(start, L).transpose();
  return X;
}

VectorXd increments(const Trajectory& run, Index start, Index L) {
  return (run.state.row(0).segment(start + 1, L) - run.state.row(0).segment(start, L)).transpose();
}

LocalModel fit(const Example& e, const Trajectory& run, Index start, Index L, Loss loss, bool with_prior = true) {
  FitOptions options;
  options.length = L;
  options.loss = loss;
  return fit_window(run, start, e.structure, options, VectorXd::Constant(1, e.sigma), with_prior ? &e.prior : nullptr);
}

TEST(Prior, ShortWindowsHaveTheClosedFormPosterior) {
  const Example e;
  std::mt19937_64 generator(7);
  const Trajectory run = test::gaussian_run(e.structure, e.theta, e.sigma, 40, generator);
  for (const Index L : {1, 2, 3}) {
    const Index start = 20;
    const MatrixXd X = regressors(run, start, L);
    const VectorXd y = increments(run, start, L);
    const MatrixXd P = e.prior.sd.cwiseAbs2().cwiseInverse().asDiagonal();
    const MatrixXd covariance = (X.transpose() * X / (e.sigma * e.sigma) + P).inverse();
    const VectorXd theta = covariance * (X.transpose() * y / (e.sigma * e.sigma) + P * e.prior.mean);
    for (const CovarianceKind kind : {CovarianceKind::model, CovarianceKind::sandwich}) {
      FitOptions options;
      options.length = L;
      options.loss = Loss::trivial;
      options.covariance = kind;
      const LocalModel model = fit_window(run, start, e.structure, options, VectorXd::Constant(1, e.sigma), &e.prior);
      EXPECT_TRUE(near(model.theta, theta, prior_rounding)) << "L = " << L;
      EXPECT_TRUE(near(model.covariance, covariance, prior_rounding)) << "L = " << L;
      EXPECT_NEAR(model.noise_variance(0), (y - X * theta).squaredNorm() / static_cast<double>(L), prior_rounding);
      EXPECT_EQ(model.rank, L);
      EXPECT_EQ(model.status, L < 3 ? FitStatus::rank_deficient : FitStatus::converged);
      const VectorXd information = 1.0 - covariance.diagonal().array() / e.prior.sd.array().square();
      EXPECT_TRUE(near(model.information, information, prior_rounding));
    }
  }
}

TEST(Prior, ShortWindowsWithoutOneHaveMinimumNorm) {
  const Example e;
  std::mt19937_64 generator(7);
  const Trajectory run = test::gaussian_run(e.structure, e.theta, e.sigma, 40, generator);
  const LocalModel model = fit(e, run, 20, 1, Loss::huber, false);
  const VectorXd phi = regressors(run, 20, 1).row(0);
  const VectorXd expected = phi * increments(run, 20, 1)(0) / phi.squaredNorm();
  EXPECT_TRUE(near(model.theta, expected, prior_rounding));
  EXPECT_EQ(model.status, FitStatus::rank_deficient);
  EXPECT_EQ(model.rank, 1);
  EXPECT_TRUE(model.covariance.array().isNaN().all());
}

TEST(Prior, LongWindowsHaveTheClosedFormPosterior) {
  const Example e;
  std::mt19937_64 generator(8);
  const Trajectory run = test::gaussian_run(e.structure, e.theta, e.sigma, 26, generator);
  const MatrixXd X = regressors(run, 0, 25);
  const VectorXd y = increments(run, 0, 25);
  const MatrixXd P = e.prior.sd.cwiseAbs2().cwiseInverse().asDiagonal();
  const VectorXd theta =
      (X.transpose() * X / 0.01 + P).ldlt().solve(VectorXd(X.transpose() * y / 0.01 + P * e.prior.mean));
  const double s2 = (y - X * theta).squaredNorm() / 22;
  // Degrees of freedom that the data determine: the trace of the hat matrix.
  const double f = ((X.transpose() * X / 0.01 + P).inverse() * X.transpose() * X / 0.01).trace();
  const double unbiased = (y - X * theta).squaredNorm() / (25 - f);
  const LocalModel model = fit(e, run, 0, 25, Loss::trivial);
  EXPECT_TRUE(near(model.theta, theta, prior_rounding));
  EXPECT_TRUE(near(model.covariance, (X.transpose() * X / unbiased + P).inverse(), prior_rounding));
  EXPECT_NEAR(model.noise_variance(0), s2, prior_rounding);
}

TEST(Prior, UnexcitedDirectionsStayAtThePrior) {
  const Example e;
  std::mt19937_64 generator(9);
  Trajectory run = test::gaussian_run(e.structure, e.theta, e.sigma, 26, generator);
  run.input.setZero();
  for (const CovarianceKind kind : {CovarianceKind::model, CovarianceKind::sandwich}) {
    FitOptions options;
    options.covariance = kind;
    const LocalModel model = fit_window(run, 0, e.structure, options, VectorXd::Constant(1, e.sigma), &e.prior);
    EXPECT_TRUE(near(model.theta.tail(2), e.prior.mean.tail(2), prior_rounding));
    EXPECT_TRUE(near(model.covariance.diagonal().tail(2), e.prior.sd.tail(2).cwiseAbs2(), prior_rounding));
    EXPECT_TRUE(near(model.information.tail(2), VectorXd::Zero(2), prior_rounding));
    EXPECT_GT(model.information(0), 0.1);
    EXPECT_EQ(model.status, FitStatus::rank_deficient);
  }
}

TEST(Prior, AWideOneChangesNothingAndANarrowOneDecides) {
  const Example e;
  std::mt19937_64 generator(10);
  const Trajectory run = test::gaussian_run(e.structure, e.theta, e.sigma, 26, generator);
  for (const Loss loss : {Loss::trivial, Loss::huber, Loss::tukey}) {
    Example wide = e, narrow = e;
    wide.prior.sd.setConstant(1e7);
    narrow.prior.sd.setConstant(1e-9);
    const LocalModel free = fit(e, run, 0, 25, loss, false);
    const LocalModel loose = fit(wide, run, 0, 25, loss);
    constexpr double prior_pull = 1e-9;  // (1e7)^-2 divided by an information of about 100, and rounding
    EXPECT_TRUE(near(loose.theta, free.theta, prior_pull)) << name_of(loss);
    EXPECT_TRUE(near(loose.covariance, free.covariance, prior_pull)) << name_of(loss);
    EXPECT_TRUE(near(fit(narrow, run, 0, 25, loss).theta, e.prior.mean, 1e-12)) << name_of(loss);
  }
}

GlobalModel global_of(double variance) {
  GlobalModel global;
  global.theta = VectorXd::Zero(1);
  global.covariance = MatrixXd::Constant(1, 1, variance);
  global.transitions = 100;
  return global;
}

TEST(DefaultPriorSd, IsThreeTimesTheRobustSpread) {
  const MatrixXd fits{{-2.0, 1.0, 0.0, 3.0, 1e9}};  // median 1; absolute deviations 3 0 1 2 1e9, whose median is 2
  EXPECT_NEAR(default_prior_sd(fits, global_of(1.0), 25)(0), 3 * 1.4826 * 2, 1e-12);
}

TEST(DefaultPriorSd, FallsBackInTheStatedOrder) {
  const MatrixXd mostly_equal{{1.0, 1.0, 1.0, 5.0}};  // the sample variance is 12 / 3
  EXPECT_NEAR(default_prior_sd(mostly_equal, global_of(1.0), 25)(0), 3 * 2.0, 1e-12);
  EXPECT_NEAR(default_prior_sd(MatrixXd::Ones(1, 4), global_of(0.01), 25)(0), 3 * 0.1 * 2, 1e-12);
  EXPECT_NEAR(default_prior_sd(MatrixXd(1, 0), global_of(0.01), 25)(0), 3 * 0.1 * 2, 1e-12);
  EXPECT_EQ(default_prior_sd(MatrixXd(1, 0), global_of(0.0), 25)(0), 1.0);
  EXPECT_EQ(default_prior_sd(MatrixXd(1, 0), global_of(std::nan("")), 25)(0), 1.0);
}

TEST(FitWindowArguments, AreChecked) {
  const Example e;
  std::mt19937_64 generator(11);
  const Trajectory run = test::gaussian_run(e.structure, e.theta, e.sigma, 26, generator);
  const VectorXd sigma = VectorXd::Ones(1);
  FitOptions options;
  EXPECT_THROW(fit_window(run, 1, e.structure, options, sigma, nullptr), std::invalid_argument);
  EXPECT_THROW(fit_window(run, -1, e.structure, options, sigma, nullptr), std::invalid_argument);
  EXPECT_THROW(fit_window(run, 0, e.structure, options, VectorXd::Zero(1), nullptr), std::invalid_argument);
  EXPECT_THROW(fit_window(run, 0, e.structure, options, VectorXd::Ones(2), nullptr), std::invalid_argument);
  ParameterPrior bad = e.prior;
  bad.sd(1) = 0.0;
  EXPECT_THROW(fit_window(run, 0, e.structure, options, sigma, &bad), std::invalid_argument);
  bad = {VectorXd::Zero(2), VectorXd::Ones(2)};
  EXPECT_THROW(fit_window(run, 0, e.structure, options, sigma, &bad), std::invalid_argument);
}

TEST(FitWindowsOptions, AreChecked) {
  const Example e;
  std::mt19937_64 generator(12);
  const Recording recording = test::make_recording({test::gaussian_run(e.structure, e.theta, e.sigma, 60, generator)});
  const auto rejects = [&](auto change) {
    FitOptions options;
    change(options);
    EXPECT_THROW(fit_windows(recording, options), ConfigurationError);
  };
  rejects([](FitOptions& o) { o.length = 0; });
  rejects([](FitOptions& o) { o.step = 0; });
  rejects([](FitOptions& o) { o.loss_scale = -1; });
  rejects([](FitOptions& o) { o.sigma = -1.0; });
  rejects([](FitOptions& o) { o.prior_sd = {1.0, 1.0}; });
  rejects([](FitOptions& o) { o.prior_sd = {-1.0}; });
  rejects([](FitOptions& o) { o.max_iterations = 0; });
  FitOptions longer;
  longer.length = 60;
  EXPECT_THROW(fit_windows(recording, longer), DataError);
}

}  // namespace
}  // namespace modebank
