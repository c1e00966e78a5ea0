#include "ident/simulate/simulate.hpp"

#include <algorithm>
#include <boost/random/bernoulli_distribution.hpp>
#include <boost/random/discrete_distribution.hpp>
#include <boost/random/normal_distribution.hpp>
#include <cmath>
#include <string>
#include <string_view>

#include "ident/base/linalg.hpp"
#include "ident/base/seed.hpp"
#include "ident/simulate/input_law.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

constexpr double row_sum_tolerance = 1e-9;

LinearStructure structure_of(const SimulationOptions& o) { return {o.states, o.inputs, o.intercept}; }

void require_setting(bool ok, const std::string& message) {
  if (!ok) throw ConfigurationError("simulation: " + message);
}

void require_nonnegative_setting(double value, const std::string& name) {
  require_setting(value >= 0.0 && std::isfinite(value),
                  name + " = " + std::to_string(value) + " is negative or not finite");
}

void require_fraction_setting(double value, const std::string& name) {
  require_setting(value >= 0.0 && value <= 1.0, name + " = " + std::to_string(value) + " is outside 0..1");
}

void check_commands(const CommandOptions& o) {
  require_setting(o.samples >= 2, "samples = " + std::to_string(o.samples) + " is below 2");
  require_setting(o.hold_samples >= 1, "hold_samples = " + std::to_string(o.hold_samples) + " is below 1");
  require_nonnegative_setting(o.input_amplitude, "input_amplitude");
  require_nonnegative_setting(o.input_quantum, "input_quantum");
  require_fraction_setting(o.standstill_fraction, "standstill_fraction");
  require_fraction_setting(o.equal_fraction, "equal_fraction");
  require_fraction_setting(o.standstill_fraction + o.equal_fraction, "standstill_fraction + equal_fraction");
}

void check_runs(Index runs, double dt_s) {
  require_setting(runs >= 1, "runs = " + std::to_string(runs) + " is below 1");
  require_setting(dt_s > 0.0 && std::isfinite(dt_s), "dt_s = " + std::to_string(dt_s) + " is not positive");
}

void check_modes(const SimulationOptions& o) {
  require_setting(!o.modes.empty(), "no mode is given");
  require_setting(o.states >= 1 && o.inputs >= 0, "expected at least one state and zero or more inputs");
  const Index p = structure_of(o).parameters();
  for (const Eigen::VectorXd& theta : o.modes)
    require_setting(
        theta.size() == p && theta.allFinite(),
        "a mode has " + std::to_string(theta.size()) + " parameters; it needs " + std::to_string(p) + " finite ones");
  require_setting(
      o.process_sd.size() == 1 || o.process_sd.size() == o.modes.size(),
      std::to_string(o.process_sd.size()) + " process_sd values for " + std::to_string(o.modes.size()) + " modes");
  for (const double sd : o.process_sd) require_nonnegative_setting(sd, "process_sd");
}

void check_transition(const Eigen::MatrixXd& T, Index modes) {
  require_setting(T.rows() == modes && T.cols() == modes, "the transition matrix is " + std::to_string(T.rows()) +
                                                              " x " + std::to_string(T.cols()) + " for " +
                                                              std::to_string(modes) + " modes");
  require_setting((T.array() >= 0.0).all(), "the transition matrix has a negative or undefined entry");
  for (Index i = 0; i < modes; ++i)
    require_setting(std::abs(T.row(i).sum() - 1.0) <= row_sum_tolerance,
                    "row " + std::to_string(i) + " of the transition matrix sums to " + std::to_string(T.row(i).sum()));
}

void check(const SimulationOptions& o) {
  check_modes(o);
  if (o.transition.size() > 0) check_transition(o.transition, static_cast<Index>(o.modes.size()));
  require_setting(o.dwell_samples == 0.0 || (o.dwell_samples >= 1.0 && std::isfinite(o.dwell_samples)),
                  "dwell_samples = " + std::to_string(o.dwell_samples) + "; expected 0, or at least 1");
  check_runs(o.runs, o.dt_s);
  check_commands(o);
  require_nonnegative_setting(o.measurement_sd, "measurement_sd");
  require_nonnegative_setting(o.outlier_sd, "outlier_sd");
  require_fraction_setting(o.outlier_fraction, "outlier_fraction");
}

/// Transition matrix of the modes, with rows that sum to one. Unused if no run changes its mode.
Eigen::MatrixXd transition_of(const SimulationOptions& o) {
  if (o.transition.size() > 0) return o.transition;
  const Index K = static_cast<Index>(o.modes.size());
  if (K == 1) return Eigen::MatrixXd::Ones(1, 1);
  const double leave = 1.0 / o.dwell_samples;
  Eigen::MatrixXd T = Eigen::MatrixXd::Constant(K, K, leave / static_cast<double>(K - 1));
  T.diagonal().setConstant(1.0 - leave);
  return T;
}

/// The stationary distribution pi, with pi' T = pi'. If there are several solutions, the one of least norm.
Eigen::VectorXd stationary_distribution(const Eigen::MatrixXd& T) {
  const Index K = T.rows();
  Eigen::MatrixXd equations(K + 1, K);
  equations.topRows(K) = T.transpose() - Eigen::MatrixXd::Identity(K, K);
  equations.row(K).setOnes();
  const Eigen::VectorXd pi = solve_least_squares(equations, Eigen::VectorXd::Unit(K + 1, K)).cwiseMax(0.0);
  return pi / pi.sum();
}

int draw_from(const Eigen::VectorXd& probabilities, std::mt19937_64& generator) {
  return boost::random::discrete_distribution<int>(probabilities.begin(), probabilities.end())(generator);
}

Eigen::VectorXi draw_modes(const SimulationOptions& o, Index run, std::mt19937_64& generator) {
  const Index K = static_cast<Index>(o.modes.size());
  if (o.transition.size() == 0 && o.dwell_samples == 0.0)
    return Eigen::VectorXi::Constant(o.samples, static_cast<int>((run / 2) % K));
  const Eigen::MatrixXd T = transition_of(o);
  Eigen::VectorXi modes(o.samples);
  modes(0) = draw_from(stationary_distribution(T), generator);
  for (Index k = 1; k < o.samples; ++k) modes(k) = draw_from(T.row(modes(k - 1)).transpose(), generator);
  return modes;
}

/// Draws `size` values of N(0, sd^2).
Eigen::VectorXd draw_noise(Index size, double sd, std::mt19937_64& generator) {
  boost::random::normal_distribution<double> standard;
  Eigen::VectorXd noise(size);
  for (double& value : noise) value = sd * standard(generator);
  return noise;
}

/// Simulates the states, which start at zero. The mode of sample k drives the transition to sample k + 1.
Eigen::MatrixXd drive_states(const SimulationOptions& o, const Eigen::VectorXi& modes, const Eigen::MatrixXd& inputs,
                             std::mt19937_64& generator) {
  std::vector<LinearModel> models;
  for (const Eigen::VectorXd& theta : o.modes) models.push_back(unpack(structure_of(o), theta));
  Eigen::MatrixXd states = Eigen::MatrixXd::Zero(o.states, o.samples);
  for (Index k = 0; k + 1 < o.samples; ++k) {
    const std::size_t s = static_cast<std::size_t>(modes(k));
    states.col(k + 1) = models[s].next(states.col(k), inputs.col(k)) +
                        draw_noise(o.states, o.process_sd.size() == 1 ? o.process_sd[0] : o.process_sd[s], generator);
    require_setting(states.col(k + 1).allFinite(), "mode " + std::to_string(s) + " is unstable: the state overflows");
  }
  return states;
}

/// Adds measurement noise to every sample (column), and outliers to some samples.
void add_noise(Eigen::MatrixXd& samples, const SimulationOptions& o, std::mt19937_64& generator) {
  boost::random::bernoulli_distribution<double> is_outlier(o.outlier_fraction);
  for (Index k = 0; k < samples.cols(); ++k) {
    samples.col(k) += draw_noise(samples.rows(), o.measurement_sd, generator);
    const bool outlier = is_outlier(generator);
    const Eigen::VectorXd error = draw_noise(samples.rows(), o.outlier_sd, generator);
    if (outlier) samples.col(k) += error;
  }
}

/// Run names "00", "01", ... All have the number of digits of the last run, at least two, so that names in byte order
/// are in run order.
std::string simulated_run_name(Index run, Index runs) {
  const std::size_t width = std::max<std::size_t>(2, std::to_string(runs - 1).size());
  const std::string digits = std::to_string(run);
  return std::string(width - digits.size(), '0') + digits;
}

SimulatedRun simulate_run(const SimulationOptions& o, std::uint64_t seed, Index i) {
  // Each purpose has its own generator, so that changing the noise or the outliers does not change modes and inputs.
  const auto generator = [&](std::string_view use) { return make_generator(seed, use, static_cast<std::uint64_t>(i)); };
  auto mode_generator = generator("simulate.modes"), input_generator = generator("simulate.inputs"),
       process_generator = generator("simulate.process"), measurement_generator = generator("simulate.measurement");
  SimulatedRun run;
  run.mode = draw_modes(o, i, mode_generator);
  run.measured.run = simulated_run_name(i, o.runs);
  run.measured.role = i % 2 == 0 ? Role::train : Role::test;
  run.measured.time_s = Eigen::VectorXd::LinSpaced(o.samples, 0, static_cast<double>(o.samples - 1)) * o.dt_s;
  run.measured.input = draw_inputs(o, input_generator);
  run.measured.truth = drive_states(o, run.mode, run.measured.input, process_generator);
  run.measured.state = run.measured.truth;
  add_noise(run.measured.state, o, measurement_generator);
  return run;
}

}  // namespace

std::vector<SimulatedRun> simulate(const SimulationOptions& options, std::uint64_t seed) {
  check(options);
  std::vector<SimulatedRun> runs;
  for (Index i = 0; i < options.runs; ++i) runs.push_back(simulate_run(options, seed, i));
  return runs;
}

}  // namespace modebank
