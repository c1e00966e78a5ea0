#include <limits>

#include "ident/fit/fit_window.hpp"
#include "ident/fit/fit_windows.hpp"
#include "tests/ident/ident_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Calls fit_windows on one run of 60 samples. Checks that nothing is printed and that numbers and status agree.
WindowFits fit_quietly(const MatrixXd& state, const MatrixXd& input, const FitOptions& options) {
  ::testing::internal::CaptureStderr();
  ::testing::internal::CaptureStdout();
  const WindowFits fits = fit_windows(test::make_recording({test::make_run(state, input)}), options);
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  for (Index i = 0; i < fits.count(); ++i) {
    const bool failed = fits.status(i) == static_cast<int>(FitStatus::failed);
    EXPECT_EQ(fits.parameters.col(i).allFinite(), !failed) << "window " << i;
    EXPECT_EQ(fits.noise_variance.col(i).allFinite(), !failed) << "window " << i;
    if (!failed && options.prior == Prior::global) {
      EXPECT_TRUE(fits.covariance.col(i).allFinite()) << "window " << i;
    }
    if (!failed) {
      EXPECT_GT(fits.noise_variance.col(i).minCoeff(), 0.0) << "window " << i;
    }
  }
  return fits;
}

struct Signals {
  MatrixXd state, input;
};

Signals excited(double noise_sd) {
  std::mt19937_64 generator(21);
  const Trajectory run = test::gaussian_run(test::skid_structure, test::skid_theta, noise_sd, 60, generator);
  return {run.state, run.input};
}

class Degenerate : public ::testing::TestWithParam<std::tuple<Loss, Prior, CovarianceKind>> {
 protected:
  FitOptions options() const {
    FitOptions o;
    std::tie(o.loss, o.prior, o.covariance) = GetParam();
    return o;
  }
};

TEST_P(Degenerate, ConstantDataHaveRankOne) {
  const WindowFits fits = fit_quietly(MatrixXd::Constant(1, 60, 0.4), MatrixXd::Constant(2, 60, 0.2), options());
  EXPECT_TRUE((fits.rank.array() == 1).all());
  EXPECT_TRUE((fits.status.array() == 2).all());
  constexpr double svd_rounding = 1e-12;
  EXPECT_TRUE(test::near(fits.parameters, MatrixXd::Zero(3, fits.count()), svd_rounding));
}

TEST_P(Degenerate, AllZeroDataHaveRankZero) {
  const WindowFits fits = fit_quietly(MatrixXd::Zero(1, 60), MatrixXd::Zero(2, 60), options());
  EXPECT_TRUE((fits.rank.array() == 0).all());
  EXPECT_TRUE((fits.status.array() == 2).all());
  EXPECT_TRUE((fits.parameters.array() == 0.0).all());
  EXPECT_TRUE((fits.condition.array() == std::numeric_limits<double>::infinity()).all());
}

TEST_P(Degenerate, NoiseFreeDataGiveTheTruth) {
  const Signals s = excited(0.0);
  const WindowFits fits = fit_quietly(s.state, s.input, options());
  constexpr double conditioned_rounding = 1e-11;
  EXPECT_TRUE(test::near(fits.parameters, test::skid_theta.replicate(1, fits.count()), conditioned_rounding));
}

TEST_P(Degenerate, HugeAndTinyUnitsDoNotMatter) {
  const Signals s = excited(0.05);
  for (const double unit : {1e-30, 1e30}) {
    const WindowFits fits = fit_quietly(s.state * unit, s.input * unit, options());
    EXPECT_TRUE((fits.status.array() == 0).all()) << unit;
    const WindowFits plain = fit_quietly(s.state, s.input, options());
    constexpr double optimum_tolerance = 1e-8;
    EXPECT_TRUE(test::near(fits.parameters, plain.parameters, optimum_tolerance)) << unit;
  }
}

TEST_P(Degenerate, NumbersWithoutSquaresAreAStatus) {
  const Signals s = excited(0.05);
  FitOptions o = options();
  o.prior_sd = {1.0};
  fit_quietly(s.state * 1e300, s.input * 1e300, o);
  fit_quietly(s.state * 1e-300, s.input * 1e-300, o);
  MatrixXd spike = s.state;
  spike(0, 30) = 1e200;
  fit_quietly(spike, s.input, o);
}

TEST_P(Degenerate, MissingSamplesLeaveTheirTransitionsOut) {
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    Signals s = excited(0.05);
    s.state(0, 40) = bad;
    s.input(1, 20) = bad;  // affects transition 20 only
    EXPECT_TRUE((fit_quietly(s.state, s.input, options()).status.array() == 0).all());

    s.state.middleCols(10, 30).setConstant(bad);
    const WindowFits fits = fit_quietly(s.state, s.input, options());
    for (Index i = 0; i < fits.count(); ++i)
      EXPECT_EQ(fits.status(i) == 3, i >= 9 && i + 25 <= 41) << "nothing is known of the window that starts at " << i;
  }
}

TEST_P(Degenerate, MostlyExactSamplesWithFewErrorsDoNotBreak) {
  Signals s = excited(0.0);  // the median deviation of the residuals is a rounding error, so sigma is at its floor
  for (const Index k : {12, 30, 47}) s.state(0, k) += 1.0;
  const WindowFits fits = fit_quietly(s.state, s.input, options());
  if (options().loss == Loss::trivial || options().prior == Prior::none) return;
  EXPECT_TRUE((fits.status.array() != 3).all());
}

INSTANTIATE_TEST_SUITE_P(Options, Degenerate,
                         ::testing::Combine(::testing::ValuesIn(test::all_losses),
                                            ::testing::Values(Prior::none, Prior::global),
                                            ::testing::Values(CovarianceKind::model, CovarianceKind::sandwich)),
                         [](const auto& instance) {
                           return std::string(name_of(std::get<0>(instance.param))) + "_" +
                                  std::string(name_of(std::get<1>(instance.param))) +
                                  (std::get<2>(instance.param) == CovarianceKind::model ? "_model" : "_sandwich");
                         });

TEST(IterationLimit, IsAStatus) {
  Signals s = excited(0.05);
  s.state(0, 10) += 1.0;
  const Trajectory run = test::make_run(s.state, s.input);
  FitOptions options = test::whole_run(run, Loss::cauchy);
  options.max_iterations = 1;
  const LocalModel fit = fit_window(run, 0, test::skid_structure, options, VectorXd::Constant(1, 0.01), nullptr);
  EXPECT_EQ(fit.status, FitStatus::iteration_limit);
  EXPECT_TRUE(fit.theta.allFinite());
}

}  // namespace
}  // namespace modebank
