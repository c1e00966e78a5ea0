#include "ident/fit/fit_windows.hpp"

#include <tbb/global_control.h>

#include <Eigen/Cholesky>
#include <algorithm>

#include "ident/fit/fit_window.hpp"
#include "ident/fit/scale.hpp"
#include "tests/ident/ident_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::near;

constexpr double window_rounding = 1e-12;

/// Three training runs and a held-out run, with stretches of standstill and some outliers.
Recording mixed_recording() {
  std::mt19937_64 generator(3);
  std::vector<Trajectory> runs;
  for (int i = 0; i < 4; ++i) {
    runs.push_back(test::gaussian_run(test::skid_structure, test::skid_theta, 0.05, 90, generator));
    runs.back().input.middleCols(30, 35).colwise() = Eigen::Vector2d(0.2, 0.4);
    runs.back().state(0, 10) += 2.0;
    runs.back().state(0, 50) -= 1.0;
  }
  runs[2].role = Role::test;
  return test::make_recording(runs);
}

TEST(FitWindows, AreTheSameBitsForAnyThreadCount) {
  const Recording recording = mixed_recording();
  for (const Loss loss : {Loss::huber, Loss::tukey}) {
    FitOptions options;
    options.loss = loss;
    std::vector<WindowFits> results;
    for (const std::size_t threads : {1U, 2U}) {
      tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      results.push_back(fit_windows(recording, options));
    }
    EXPECT_TRUE(test::same_bits(results[0].parameters, results[1].parameters));
    EXPECT_TRUE(test::same_bits(results[0].covariance, results[1].covariance));
    EXPECT_TRUE(test::same_bits(results[0].noise_variance, results[1].noise_variance));
    EXPECT_TRUE(test::same_bits(results[0].information, results[1].information));
    EXPECT_TRUE(test::same_bits(results[0].prior_sd, results[1].prior_sd));
    EXPECT_TRUE(results[0].status == results[1].status);
  }
}

/// A window of three transitions has no residuals to estimate sigma from, so it has the sigma of its run.
TEST(FitWindows, TakeSigmaFromTheWindowOrItsRun) {
  const Recording recording = mixed_recording();
  FitOptions options;
  options.prior_sd = {0.7};
  for (const Index length : {25, 3}) {
    options.length = length;
    const WindowFits fits = fit_windows(recording, options);
    const ParameterPrior prior{fits.global.theta, fits.prior_sd};
    const Index i = 3;
    const Trajectory& run = recording.runs[0];
    const bool whole = length == 3;
    // The scale by its definition: 1.4826 times the MAD of least-squares residuals, times sqrt(N / (N - 3)).
    const Index first = whole ? 0 : fits.windows[3].start, N = whole ? run.transitions() : length;
    MatrixXd X(N, 3);
    X.col(0) = run.state.row(0).segment(first, N).transpose();
    X.rightCols(2) = run.input.middleCols(first, N).transpose();
    const VectorXd y = (run.state.row(0).segment(first + 1, N) - run.state.row(0).segment(first, N)).transpose();
    VectorXd r = y - X * (X.transpose() * X).ldlt().solve(X.transpose() * y);
    std::sort(r.begin(), r.end());
    const double middle = N % 2 ? r(N / 2) : (r(N / 2) + r(N / 2 - 1)) / 2;
    VectorXd deviation = (r.array() - middle).abs();
    std::sort(deviation.begin(), deviation.end());
    const double mad = N % 2 ? deviation(N / 2) : (deviation(N / 2) + deviation(N / 2 - 1)) / 2;
    const double sigma = 1.4826 * mad * std::sqrt(static_cast<double>(N) / static_cast<double>(N - 3));
    const LocalModel one =
        fit_window(run, fits.windows[3].start, test::skid_structure, options, VectorXd::Constant(1, sigma), &prior);
    constexpr double optimum_tolerance = 1e-9;  // this test computes sigma by normal equations
    EXPECT_TRUE(near(fits.at(i).theta, one.theta, optimum_tolerance)) << length;
  }
}

/// Windows of four lags, and one-lag fits of the same transitions. The one-lag fits must equal the results of
/// fit_windows for these transitions.
TEST(FitWindows, OneLagFitsAreOfTheSameTransitions) {
  const Recording recording = mixed_recording();
  FitOptions options;
  options.length = 20;
  options.prior_sd = {0.5};
  const WindowFits one = fit_windows(recording, options);
  options.model = "varx";
  options.state_lags = 4;
  options.input_lags = 2;
  const WindowFits many = fit_windows(recording, options), same = fit_one_lag(recording, many, options);
  ASSERT_EQ(same.count(), many.count());
  EXPECT_EQ(same.structure, test::skid_structure);
  Index compared = 0;
  for (Index i = 0, j = 0; i < same.count(); ++i) {
    const Window &window = same.windows[i], &of = many.windows[i];
    EXPECT_EQ(window.run, of.run);
    EXPECT_EQ(window.start, of.start);
    const auto elsewhere = [&] {
      const Window& at = one.windows[j];
      return at.run != window.run || at.start != window.start;
    };
    while (elsewhere()) ++j;
    EXPECT_TRUE(near(same.parameters.col(i), one.parameters.col(j), 1e-9)) << i;
    ++compared;
  }
  EXPECT_EQ(compared, one.count() - 3 * 3) << "three runs, each without its first three windows";
  options.prior_sd.assign(static_cast<std::size_t>(many.parameter_count()), 0.5);
  EXPECT_NO_THROW(fit_one_lag(recording, many, options)) << "a prior of other parameters is not used";
}

TEST(FitWindows, MarkUnexcitedWindows) {
  const Recording recording = mixed_recording();
  for (const Prior kind : {Prior::global, Prior::none}) {
    FitOptions options;
    options.prior = kind;
    const WindowFits fits = fit_windows(recording, options);
    for (Index i = 0; i < fits.count(); ++i) {
      const Index start = fits.windows[i].start;
      const bool constant_command = start >= 30 && start + 25 <= 65;
      EXPECT_EQ(fits.status(i), constant_command ? 2 : 0) << "start " << start;
      EXPECT_EQ(fits.rank(i), constant_command ? 2 : 3) << "start " << start;
      EXPECT_EQ(fits.at(i).covariance.allFinite(), kind == Prior::global || !constant_command);
    }
  }
}

TEST(FitWindows, OneWindowOverOneRunIsTheGlobalModel) {
  std::mt19937_64 generator(5);
  for (const LinearStructure& s : {LinearStructure{1, 2, false}, LinearStructure{2, 1, true}}) {
    const VectorXd truth =
        s.states == 1 ? VectorXd(test::skid_theta) : VectorXd{{-0.3, 0.1, 0.5, 0.05, 0.2, -0.4, -0.3, -0.1}};
    const Trajectory run = test::gaussian_run(s, truth, 0.1, 61, generator);
    FitOptions options = test::whole_run(run, Loss::trivial);
    options.prior = Prior::none;
    options.intercept = s.intercept;
    const WindowFits fits = fit_windows(test::make_recording({run}), options);
    ASSERT_EQ(fits.count(), 1);
    EXPECT_TRUE(near(fits.at(0).theta, fits.global.theta, window_rounding));
    EXPECT_TRUE(near(fits.at(0).covariance, fits.global.covariance, window_rounding));
    const double q = static_cast<double>(s.regressors());
    EXPECT_TRUE(near(fits.at(0).noise_variance, fits.global.noise_variance() * 60.0 / (60.0 - q), window_rounding));
    EXPECT_TRUE(near(fits.global.theta, truth, 0.25)) << "five standard errors";
  }
}

TEST(FitWindows, SingleTransitionsGoToTheRunsScale) {
  const Recording recording = mixed_recording();
  FitOptions options;
  options.length = 1;
  const WindowFits fits = fit_windows(recording, options);
  ASSERT_EQ(fits.count(), 3 * 89);
  EXPECT_TRUE((fits.status.array() == 2).all());
  EXPECT_TRUE((fits.rank.array() <= 1).all());
  EXPECT_TRUE(fits.parameters.allFinite());
  EXPECT_TRUE(fits.covariance.allFinite());
  EXPECT_GT(fits.noise_variance.minCoeff(), 0.0);
}

TEST(NoiseVariance, IsConsistentUnderGaussianNoise) {
  std::mt19937_64 generator(6);
  constexpr double sd = 0.2;
  const LinearStructure two{2, 1, true};
  const VectorXd truth{{-0.3, 0.1, 0.5, 0.05, 0.2, -0.4, -0.3, -0.1}};
  const Trajectory one_state = test::gaussian_run(test::skid_structure, test::skid_theta, sd, 20001, generator);
  const Trajectory two_states = test::gaussian_run(two, truth, sd, 20001, generator);
  for (const Loss loss : {Loss::trivial, Loss::huber, Loss::cauchy, Loss::softlone, Loss::tukey, Loss::arctan}) {
    constexpr double four_standard_errors = 4 * 0.012 * sd * sd;  // sqrt(2 / 20000) = 0.010; an efficiency of 0.7 gives
                                                                  // 0.010 / sqrt(0.7)
    const LocalModel a = fit_window(one_state, 0, test::skid_structure, test::whole_run(one_state, loss),
                                    VectorXd::Constant(1, sd), nullptr);
    EXPECT_NEAR(a.noise_variance(0), sd * sd, four_standard_errors) << name_of(loss);
    const LocalModel b =
        fit_window(two_states, 0, two, test::whole_run(two_states, loss), VectorXd::Constant(2, sd), nullptr);
    EXPECT_TRUE(near(b.noise_variance, VectorXd::Constant(2, sd * sd), four_standard_errors)) << name_of(loss);
  }
}

TEST(InlierFraction, CountsSamplesThatKeepHalfTheirWeight) {
  std::mt19937_64 generator(13);
  Trajectory run = test::gaussian_run(test::skid_structure, test::skid_theta, 0.0, 101, generator);
  run.state(0, 100) += 10.0;  // one bad transition, whose Huber weight is 1.345 sigma / 10
  const LocalModel fit =
      fit_window(run, 0, test::skid_structure, test::whole_run(run, Loss::huber), VectorXd::Constant(1, 1.0), nullptr);
  EXPECT_DOUBLE_EQ(fit.inlier_fraction, 0.99);
}

TEST(RobustScale, MedianAndMad) {
  EXPECT_EQ(median(Eigen::Vector3d(3, 1, 2)), 2.0);
  EXPECT_EQ(median(Eigen::Vector4d(4, 1, 3, 2)), 2.5);
  EXPECT_TRUE(std::isnan(median(VectorXd())));
  EXPECT_DOUBLE_EQ(normalised_mad(VectorXd{{1, 2, 3, 4, 100}}), 1.4826);
}

}  // namespace
}  // namespace modebank
