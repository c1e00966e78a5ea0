// Fits of one linear motion to its errors several samples ahead.
#include "ident/fit/horizon_fit.hpp"

#include <gtest/gtest.h>

#include <boost/random/normal_distribution.hpp>
#include <cmath>
#include <random>

#include "ident/base/not_a_number.hpp"
#include "ident/fit/global_model.hpp"

namespace modebank {
namespace {

/// y = x + v, x[k+1] = .95 x[k] + .1 u[k] + w. The noise in v is five times that in w.
Recording measured_with_noise(Index runs) {
  std::mt19937_64 generator(11);
  boost::random::normal_distribution<double> normal;
  Recording recording{{{"y", ""}}, {{"u", ""}}, {}};
  for (Index r = 0; r < runs; ++r) {
    Trajectory run;
    run.run = std::to_string(r);
    run.time_s = Eigen::VectorXd::LinSpaced(300, 0.0, 299.0);
    run.state.resize(1, 300);
    run.input.resize(1, 300);
    double x = 0.0;
    for (Index k = 0; k < 300; ++k) {
      run.input(k) = k % 25 == 0 ? normal(generator) : run.input(k - 1);
      run.state(k) = x + 0.5 * normal(generator);
      x += -0.05 * x + 0.1 * run.input(k) + 0.1 * normal(generator);
    }
    recording.runs.push_back(run);
  }
  return recording;
}

TEST(HorizonFit, OfOneSampleIsLeastSquares) {
  const Recording recording = measured_with_noise(2);
  for (const LinearStructure& s : {LinearStructure{1, 1, true}, LinearStructure{1, 1, true, 3, 2}}) {
    const Eigen::VectorXd theta = fit_global(recording, s).theta;
    const Eigen::VectorXd disturbed = theta + Eigen::VectorXd::Constant(theta.size(), 0.05);
    EXPECT_LT((fit_over_horizon(recording, s, disturbed, 1) - theta).norm(), 1e-8);
  }
}

/// The sums of squares are those of the plain recursion, and no step in any direction makes them smaller.
TEST(HorizonFit, EndsWhereTheErrorsOfThePlainRecursionAreSmallest) {
  Recording recording = measured_with_noise(2);
  recording.runs[0].state(100) = not_a_number;
  const LinearStructure s{1, 1, true, 3, 2};
  const Index h = 9;
  const auto squares = [&](const Eigen::VectorXd& theta) {
    double sum = 0.0;
    for (const Trajectory& run : recording.runs)
      for (Index origin = s.first_transition(); origin < run.transitions(); origin += 3) {
        Eigen::VectorXd y = run.state.row(0).transpose();
        for (Index k = origin + 1; k < std::min(run.samples(), origin + h + 1); ++k) {
          Eigen::VectorXd phi(6);
          phi << y(k - 1), y(k - 2), y(k - 3), run.input(k - 1), run.input(k - 2), 1.0;
          y(k) = y(k - 1) + theta.dot(phi);
          const double error = run.state(k) - y(k);
          EXPECT_TRUE(std::isnan(error) ||
                      std::abs(error - errors_ahead(s, theta, run, origin, h)(k - origin - 1)) < 1e-12);
          sum += std::isnan(error) ? 0.0 : error * error;
        }
      }
    return sum;
  };
  const Eigen::VectorXd theta = fit_over_horizon(recording, s, fit_global(recording, s).theta, h);
  const double least = squares(theta);
  for (Index j = 0; j < theta.size(); ++j)
    for (const double step : {-1e-3, 1e-3})
      EXPECT_GT(squares(theta + step * Eigen::VectorXd::Unit(theta.size(), j)), least) << j;
}

/// Least squares take the noise of the measurement for a fast decay. Errors far ahead do not.
TEST(HorizonFit, FindsTheSystemBehindNoiseThatIsNoStates) {
  const Recording recording = measured_with_noise(6);
  const LinearStructure s{1, 1, false};
  const Eigen::VectorXd one_step = fit_global(recording, s).theta, truth = Eigen::Vector2d(-0.05, 0.1);
  EXPECT_GT((one_step - truth).norm(), 0.2);
  EXPECT_LT((fit_over_horizon(recording, s, one_step, 40) - truth).norm(), 0.02);
}

TEST(HorizonFit, WithoutAnOriginItIsTheStart) {
  Recording recording = measured_with_noise(1);
  recording.runs[0].role = Role::test;
  const Eigen::VectorXd start = Eigen::Vector2d(-0.3, 0.2);
  EXPECT_EQ(fit_over_horizon(recording, {1, 1, false}, start, 5), start);
}

}  // namespace
}  // namespace modebank
