#include "ident/simulate/simulate.hpp"

#include <cmath>
#include <set>

#include "ident/base/seed.hpp"
#include "ident/fit/global_model.hpp"
#include "ident/simulate/input_law.hpp"
#include "modebank/base/error.hpp"
#include "tests/ident/ident_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::near;

constexpr std::uint64_t seed = 17;
constexpr double simulation_rounding = 1e-12;

/// Two modes, one state, two inputs.
SimulationOptions two_modes() {
  SimulationOptions options;
  options.modes = {Eigen::Vector3d(-0.3, -0.4, 0.5), Eigen::Vector3d(-0.8, -0.1, 0.1)};
  options.process_sd = {0.02, 0.1};
  options.dwell_samples = 50;
  options.runs = 4;
  options.samples = 20000;
  return options;
}

/// w[k] = x[k+1] - prediction by the mode of transition k, for the transitions of one mode.
VectorXd process_noise(const SimulatedRun& run, const SimulationOptions& options, int mode) {
  const LinearModel model = unpack({options.states, options.inputs, options.intercept}, options.modes[mode]);
  std::vector<double> noise;
  for (Index k = 0; k < run.measured.transitions(); ++k) {
    if (run.mode(k) != mode) continue;
    const VectorXd next = model.next(run.measured.truth.col(k), run.measured.input.col(k));
    for (Index i = 0; i < next.size(); ++i) noise.push_back(run.measured.truth(i, k + 1) - next(i));
  }
  return Eigen::Map<VectorXd>(noise.data(), static_cast<Index>(noise.size()));
}

double sd(const VectorXd& values) { return std::sqrt((values.array() - values.mean()).square().mean()); }

TEST(Simulate, SameSeedSameDataAndRunsDoNotDependOnTheirNumber) {
  SimulationOptions options = two_modes();
  options.samples = 50;
  options.measurement_sd = 0.01;
  const auto first = simulate(options, seed), again = simulate(options, seed), other = simulate(options, seed + 1);
  options.runs = 2;
  const auto fewer = simulate(options, seed);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_TRUE(near(first[i].measured.state, again[i].measured.state, 0.0));
    EXPECT_TRUE(near(first[i].measured.state, fewer[i].measured.state, 0.0));
    EXPECT_TRUE(near(first[i].measured.input, again[i].measured.input, 0.0));
    EXPECT_TRUE(first[i].mode == again[i].mode);
    EXPECT_FALSE(near(first[i].measured.input, other[i].measured.input, 1e-6));
  }
  EXPECT_FALSE(near(first[0].measured.input, first[1].measured.input, 1e-6));
}

TEST(Simulate, NamesRolesAndTimes) {
  SimulationOptions options = two_modes();
  options.samples = 3;
  options.runs = 101;
  options.dt_s = 0.25;
  const auto runs = simulate(options, seed);
  EXPECT_EQ(runs[0].measured.run, "000");
  EXPECT_EQ(runs[100].measured.run, "100");
  EXPECT_EQ(runs[0].measured.role, Role::train);
  EXPECT_EQ(runs[1].measured.role, Role::test);
  EXPECT_TRUE(near(runs[0].measured.time_s, Eigen::Vector3d(0, 0.25, 0.5), simulation_rounding));
  options.runs = 2;
  EXPECT_EQ(simulate(options, seed)[1].measured.run, "01");
}

TEST(Simulate, TransitionsHaveTheirFrequencies) {
  SimulationOptions options = two_modes();
  options.transition = MatrixXd{{0.9, 0.1}, {0.3, 0.7}};
  MatrixXd counts = MatrixXd::Zero(2, 2);
  for (const SimulatedRun& run : simulate(options, seed))
    for (Index k = 0; k + 1 < run.mode.size(); ++k) counts(run.mode(k), run.mode(k + 1)) += 1;
  const MatrixXd frequencies = counts.rowwise().sum().cwiseInverse().asDiagonal() * counts;
  constexpr double four_standard_errors = 0.013;  // the standard error is sqrt(0.3 * 0.7 / 20000) = 0.0032 in the rarer
                                                  // mode
  EXPECT_TRUE(near(frequencies, options.transition, four_standard_errors));
}

TEST(Simulate, ModesDwellAsLongAsAsked) {
  SimulationOptions options = two_modes();
  double switches = 0, steps = 0;
  for (const SimulatedRun& run : simulate(options, seed))
    for (Index k = 0; k + 1 < run.mode.size(); ++k, ++steps) switches += run.mode(k) != run.mode(k + 1) ? 1 : 0;
  EXPECT_NEAR(switches / steps, 1.0 / 50, 4 * std::sqrt(0.02 * 0.98 / 80000));
}

TEST(Simulate, RunsStartInTheStationaryDistribution) {
  SimulationOptions options = two_modes();
  options.transition = MatrixXd{{0.9, 0.1}, {0.3, 0.7}};  // the stationary distribution is 3/4, 1/4
  options.runs = 2000;
  options.samples = 2;
  double first = 0;
  for (const SimulatedRun& run : simulate(options, seed)) {
    first += run.mode(0) == 0 ? 1 : 0;
    EXPECT_EQ(run.measured.truth(0, 0), 0.0);
  }
  EXPECT_NEAR(first / 2000, 0.75, 4 * std::sqrt(0.75 * 0.25 / 2000));
}

TEST(Simulate, WithoutDwellEveryFoldSeesEveryMode) {
  SimulationOptions options = two_modes();
  options.dwell_samples = 0;
  options.samples = 20;
  options.runs = 8;
  const auto runs = simulate(options, seed);
  const std::vector<int> expected{0, 0, 1, 1, 0, 0, 1, 1};
  for (std::size_t i = 0; i < runs.size(); ++i) EXPECT_TRUE((runs[i].mode.array() == expected[i]).all()) << "run " << i;
}

TEST(Simulate, NoisesHaveTheirStandardDeviations) {
  SimulationOptions options = two_modes();
  options.measurement_sd = 0.05;
  const SimulatedRun run = simulate(options, seed).front();
  for (const int mode : {0, 1}) {
    const VectorXd noise = process_noise(run, options, mode);
    const double expected = options.process_sd[mode];
    const double count = static_cast<double>(noise.size());
    ASSERT_GT(count, 1000);
    EXPECT_NEAR(sd(noise), expected, 4 * expected / std::sqrt(2 * count));
    EXPECT_NEAR(noise.mean(), 0.0, 4 * expected / std::sqrt(count));
  }
  const VectorXd error = (run.measured.state - run.measured.truth).transpose();
  EXPECT_NEAR(sd(error), 0.05, 4 * 0.05 / std::sqrt(2 * 20000.0));
}

TEST(Simulate, OutliersHaveTheirShareAndSize) {
  SimulationOptions options = two_modes();
  options.outlier_fraction = 0.05;
  options.outlier_sd = 3.0;
  const SimulatedRun run = simulate(options, seed).front();
  const Eigen::ArrayXd error = (run.measured.state - run.measured.truth).transpose().array();
  const double share = static_cast<double>((error != 0.0).count()) / 20000;
  EXPECT_NEAR(share, 0.05, 4 * std::sqrt(0.05 * 0.95 / 20000));
  EXPECT_NEAR(std::sqrt(error.square().sum() / (20000 * share)), 3.0, 4 * 3.0 / std::sqrt(2 * 20000 * share));
}

TEST(Simulate, MeasurementSettingsLeaveTheTruthAlone) {
  SimulationOptions options = two_modes();
  options.samples = 100;
  const auto plain = simulate(options, seed);
  options.measurement_sd = 0.3;
  options.outlier_fraction = 0.2;
  options.outlier_sd = 1.0;
  const auto noisy = simulate(options, seed);
  EXPECT_TRUE(near(plain[0].measured.truth, noisy[0].measured.truth, 0.0));
  EXPECT_FALSE(near(plain[0].measured.state, noisy[0].measured.state, 0.1));
}

TEST(Simulate, SeveralStatesWithIntercept) {
  SimulationOptions options;
  options.states = 2;
  options.inputs = 1;
  options.intercept = true;
  options.modes = {VectorXd{{-0.3, 0.1, 0.5, 0.05, 0.2, -0.4, -0.3, -0.1}}};
  options.process_sd = {0.1};
  options.input_law = InputLaw::white;
  options.samples = 20000;
  options.runs = 1;
  const SimulatedRun run = simulate(options, seed).front();
  ASSERT_EQ(run.measured.state.rows(), 2);
  ASSERT_EQ(run.measured.input.rows(), 1);
  Recording recording = test::make_recording({run.measured});
  const GlobalModel global = fit_global(recording, {2, 1, true});
  const VectorXd z =
      (global.theta - options.modes[0]).cwiseQuotient(VectorXd(global.covariance.diagonal().cwiseSqrt()));
  EXPECT_LT(z.cwiseAbs().maxCoeff(), 4.0) << z.transpose();
}

MatrixXd inputs_of(const SimulationOptions& options) {
  std::mt19937_64 generator = make_generator(seed, "test");
  return draw_inputs(options, generator);
}

TEST(InputLaw, WhiteIsUniformAndNewEverySample) {
  SimulationOptions options = two_modes();
  options.input_law = InputLaw::white;
  const MatrixXd u = inputs_of(options);
  EXPECT_LE(u.cwiseAbs().maxCoeff(), 0.5);
  EXPECT_TRUE(((u.rightCols(19999) - u.leftCols(19999)).array() != 0.0).all());
  const double variance = 1.0 / 12;  // variance of a uniform variable on +-0.5
  EXPECT_NEAR(u.array().square().mean(), variance, 4 * std::sqrt(1.0 / 180 / 40000));
  EXPECT_NEAR((u.row(0).array() * u.row(1).array()).mean(), 0.0, 4 * variance / std::sqrt(20000.0));
}

TEST(InputLaw, HoldChangesEveryHoldSamples) {
  SimulationOptions options = two_modes();
  options.input_law = InputLaw::hold;
  options.hold_samples = 7;
  const MatrixXd u = inputs_of(options);
  for (Index k = 0; k + 1 < u.cols(); ++k)
    EXPECT_EQ((u.col(k + 1) - u.col(k)).cwiseAbs().minCoeff() > 0.0, (k + 1) % 7 == 0) << "sample " << k;
}

TEST(InputLaw, DriveMixesItsCommands) {
  SimulationOptions options = two_modes();
  options.samples = 50000;
  const MatrixXd u = inputs_of(options);
  EXPECT_LE(u.cwiseAbs().maxCoeff(), 0.5);
  double still = 0, equal = 0, held = 0, ramps = 0;
  for (Index k = 1; k + 1 < u.cols(); ++k) {
    const bool zero = u.col(k).isZero(0.0);
    still += zero ? 1 : 0;
    equal += !zero && u(0, k) == u(1, k) ? 1 : 0;
    held += !zero && u.col(k) == u.col(k + 1) ? 1 : 0;
    const Eigen::Vector2d bend = u.col(k + 1) - 2 * u.col(k) + u.col(k - 1);
    ramps += u.col(k) != u.col(k + 1) && bend.cwiseAbs().maxCoeff() < simulation_rounding ? 1 : 0;
  }
  // Because length and kind of commands are independent, shares of samples equal shares of commands. For 5000 commands
  // of geometric length the standard error is about sqrt(2 p / 5000).
  const double samples = static_cast<double>(u.cols());
  EXPECT_NEAR(still / samples, 0.1, 4 * std::sqrt(2 * 0.1 / 5000));
  EXPECT_NEAR(equal / samples, 0.3, 4 * std::sqrt(2 * 0.3 / 5000));
  EXPECT_GT(held / samples, 0.3);
  EXPECT_GT(ramps / samples, 0.1);
}

TEST(InputLaw, QuantisedInputsAreTheAppliedOnes) {
  SimulationOptions options = two_modes();
  options.input_quantum = 0.08;
  options.process_sd = {0.0, 0.0};
  options.samples = 300;
  const SimulatedRun run = simulate(options, seed).front();
  const MatrixXd steps = run.measured.input / 0.08;
  EXPECT_TRUE(near(steps, steps.array().round(), simulation_rounding));
  EXPECT_GT(std::set<double>(run.measured.input.reshaped().begin(), run.measured.input.reshaped().end()).size(), 5U);
  for (const int mode : {0, 1}) EXPECT_LT(process_noise(run, options, mode).cwiseAbs().maxCoeff(), simulation_rounding);
}

TEST(SimulateOptions, AreChecked) {
  const auto rejects = [](auto change) {
    SimulationOptions options = two_modes();
    options.samples = 10;
    change(options);
    EXPECT_THROW(simulate(options, seed), ConfigurationError);
  };
  rejects([](SimulationOptions& o) { o.modes.clear(); });
  rejects([](SimulationOptions& o) { o.modes[1] = VectorXd::Zero(2); });
  rejects([](SimulationOptions& o) { o.process_sd = {0.1, 0.1, 0.1}; });
  rejects([](SimulationOptions& o) { o.process_sd[0] = -1; });
  rejects([](SimulationOptions& o) { o.transition = MatrixXd::Ones(3, 3) / 3; });
  rejects([](SimulationOptions& o) { o.transition = MatrixXd{{0.9, 0.2}, {0.5, 0.5}}; });
  rejects([](SimulationOptions& o) { o.transition = MatrixXd{{1.1, -0.1}, {0.5, 0.5}}; });
  rejects([](SimulationOptions& o) { o.dwell_samples = 0.5; });
  rejects([](SimulationOptions& o) { o.runs = 0; });
  rejects([](SimulationOptions& o) { o.samples = 1; });
  rejects([](SimulationOptions& o) { o.hold_samples = 0; });
  rejects([](SimulationOptions& o) { o.dt_s = 0; });
  rejects([](SimulationOptions& o) { o.outlier_fraction = 1.5; });
  rejects([](SimulationOptions& o) { o.equal_fraction = 0.95; });
  rejects([](SimulationOptions& o) { o.input_amplitude = std::nan(""); });
  rejects([](SimulationOptions& o) {
    o.modes[0](0) = o.modes[1](0) = 1e300;
    o.input_amplitude = 1e300;
  });
}

}  // namespace
}  // namespace modebank
