// Data that are mostly measurement noise. A model with a large R is tried, in addition to the search from exact states.
#include "filter/learn/refine/dominating_noise.hpp"

#include <gtest/gtest.h>

#include <boost/random/normal_distribution.hpp>
#include <cmath>
#include <random>

#include "filter/learn/from_mixture/bank_frame.hpp"
#include "filter/learn/refine/measurement_noise.hpp"
#include "tests/filter/learn/learn_test_support.hpp"

namespace modebank {
namespace {

/// Measured position of a target with white acceleration (standard deviation 0.3 m/s^2) every 0.1 s. R is the variance
/// of the measurement.
Recording constant_velocity(double R, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  boost::random::normal_distribution<double> normal;
  constexpr double dt_s = 0.1;
  Recording recording = test::empty_recording(1, 0);
  for (int run = 0; run < 6; ++run) {
    Eigen::MatrixXd y(1, 300);
    double x = 0.0, v = normal(generator);
    for (Index k = 0; k < y.cols(); ++k) {
      y(k) = x + std::sqrt(R) * normal(generator);
      const double a = 0.3 * normal(generator);
      x += dt_s * v + dt_s * dt_s / 2 * a;
      v += dt_s * a;
    }
    test::add_run(recording, y, Eigen::MatrixXd(0, y.cols()));
  }
  return recording;
}

/// A bank before the search for R: one mode with two state lags, by least squares.
struct LeastSquares {
  explicit LeastSquares(const Recording& data) : recording(data) {
    structure.state_lags = 2;
    fits.structure = structure;
    fits.length = 25;
    fits.step = 1;
    fits.windows = make_windows(recording, 25, 1);
    fits.global = fit_global(recording, structure);
    transitions = gather_training_transitions(recording, structure);
    bank = bank_frame(recording, structure, Eigen::MatrixXd::Constant(1, 1, 1e-9));
    bank.modes = {make_mode(structure, fits.global.theta, fits.global.residual_covariance, {}, {}, 1.0)};
    set_mode_sequence(bank, TransitionMatrix());
  }
  Fit measured() const {
    RefineOptions options;
    options.folds = 1;
    const FilterOptions filter;
    const RefineInput in{recording, fits, bank, transitions, options, filter};
    Fit given{{"", switching_model(bank), 4.0}, switching_model(bank)};
    given.bank = bank;
    given.prior = in.prior(4.0);
    MeasurementStage stage;
    return fit_with_measurement_noise(in, CrossValidation(in), given, stage);
  }

  const Recording& recording;
  LinearStructure structure = test::structure_of(recording);
  WindowFits fits;
  TrainingTransitions transitions;
  Bank bank;
};

/// Regression test: the search once found R = 4e-11 and scored 0.275 nats less than with R given. Two lags of the
/// position determine its velocity. So the process noise is small beside R, and exact states give coefficients 1 and
/// -1.
TEST(DominatingNoise, IsFoundWithTheCoefficientsThatItHid) {
  for (const std::uint64_t seed : {0, 1, 2}) {
    const Recording recording = constant_velocity(0.0225, seed);
    const LeastSquares least_squares(recording);
    ASSERT_LT(least_squares.fits.global.theta(0), 0.0) << "least squares takes the noise for motion";
    const Fit found = least_squares.measured();
    EXPECT_TRUE(found.R_estimated);
    EXPECT_NEAR(found.bank.R(0, 0), 0.0225, 0.1 * 0.0225);
    EXPECT_NEAR(found.bank.theta(0)(0), 1.0, 0.05);
    EXPECT_NEAR(found.bank.theta(0)(1), -1.0, 0.05);
  }
}

/// A search with a wrong start must not find measurement noise in data with little noise. Here the acceleration moves
/// the target in one step by 100 times the measurement error.
TEST(DominatingNoise, IsNotFoundWhereStatesAreExact) {
  const Recording recording = constant_velocity(1e-10, 0);
  const LeastSquares least_squares(recording);
  EXPECT_LT(least_squares.measured().bank.R(0, 0), 1e-7);
}

}  // namespace
}  // namespace modebank
