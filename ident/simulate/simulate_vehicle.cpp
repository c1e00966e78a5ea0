#include "ident/simulate/simulate_vehicle.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <boost/random/uniform_01.hpp>
#include <cmath>
#include <numbers>
#include <string_view>

#include "ident/base/seed.hpp"
#include "ident/simulate/input_law.hpp"
#include "ident/simulate/simulation_parts.hpp"

namespace modebank {

namespace {

using VehicleOptions = VehicleSimulationOptions;

void require_positive(double value, const std::string& name) {
  require_setting(value > 0.0 && std::isfinite(value), name + " = " + std::to_string(value) + " is not positive");
}

void check_kinds(const VehicleOptions& o) {
  const std::size_t kinds = o.friction.size();
  require_setting(kinds >= 1, "no friction coefficient is given");
  const auto check_count = [kinds](const std::vector<double>& values, const std::string& name) {
    require_setting(values.size() == 1 || values.size() == kinds,
                    std::to_string(values.size()) + " values of " + name + " for " + std::to_string(kinds) +
                        " friction coefficients: give one for each or one for all");
  };
  check_count(o.shear_m, "shear_m");
  check_count(o.resistance, "resistance");
  for (const double value : o.friction) require_positive(value, "friction");
  for (const double value : o.shear_m) require_positive(value, "shear_m");
  for (const double value : o.resistance) require_nonnegative_setting(value, "resistance");
}

std::vector<GroundKind> kinds_of(const VehicleOptions& o) {
  const auto pick = [](const std::vector<double>& values, std::size_t k) { return values[values.size() == 1 ? 0 : k]; };
  std::vector<GroundKind> kinds;
  for (std::size_t k = 0; k < o.friction.size(); ++k)
    kinds.push_back({o.friction[k], pick(o.shear_m, k), pick(o.resistance, k)});
  return kinds;
}

/// Checks the step size in advance. Friction bounds even an unstable integration, so the result would not show the
/// instability.
void check_step(const VehicleOptions& o) {
  require_nonnegative_setting(o.step_s, "step");
  const double largest_s = Vehicle::stability_margin * Vehicle::default_step_s(o.vehicle, kinds_of(o));
  require_setting(o.step_s <= largest_s, "step = " + std::to_string(o.step_s) +
                                             " s is too long for the stiffest ground: at most " +
                                             std::to_string(largest_s) + " s, or 0");
}

void check_sensors(const SensorOptions& s) {
  require_nonnegative_setting(s.gyro_noise_density, "gyro_noise_density");
  require_nonnegative_setting(s.gyro_bias_walk, "gyro_bias_walk");
  require_nonnegative_setting(s.speed_noise_sd, "speed_noise_sd");
  require_nonnegative_setting(s.wheel_quantum_m_s, "wheel_quantum");
  require_setting(std::isfinite(s.gyro_bias), "gyro_bias is not finite");
  require_setting(std::isfinite(s.lag_s), "lag_s is not finite");
  require_setting(std::isfinite(s.drift) && s.drift > -1.0,
                  "drift = " + std::to_string(s.drift) + " is out of range: above -1");
}

void check(const VehicleOptions& o) {
  const VehicleParameters& v = o.vehicle;
  require_positive(v.mass_kg, "mass_kg");
  require_positive(v.yaw_inertia_kg_m2, "yaw_inertia_kg_m2");
  require_positive(v.track_m, "track_m");
  require_nonnegative_setting(v.wheelbase_m, "wheelbase_m");
  require_positive(v.contact_m, "contact_m");
  require_positive(v.slip_speed_m_s, "slip_speed_m_s");
  require_positive(v.drive_mass_kg, "drive_mass_kg");
  require_positive(v.drive_time_s, "drive_time_s");
  require_positive(v.drive_force_N, "drive_force_N");
  require_positive(o.state_rate_hz, "state_rate_hz");
  require_nonnegative_setting(o.patch_m, "patch_m");
  require_nonnegative_setting(o.turn_scale, "turn_scale");
  require_setting(std::isfinite(o.forward_speed_m_s), "forward_speed is not finite");
  require_fraction_setting(o.outlier_fraction, "outlier_fraction");
  require_nonnegative_setting(o.outlier_sd, "outlier_sd");
  require_setting(o.measured >= 1 && o.measured <= 3,
                  std::to_string(o.measured) + " states: a vehicle has yaw rate, forward speed and sideways speed");
  require_setting(o.commands.inputs == 2, std::to_string(o.commands.inputs) + " inputs: a vehicle has two");
  check_kinds(o);
  check_step(o);
  check_sensors(o.sensors);
  check_runs(o.runs, o.dt_s);
  check_commands(o.commands);
}

/// Splits the drawn wheel speeds into a forward and a turning part. Then shifts the forward part, scales the turning
/// part and adds both again, in whole quanta. Both wheels are exactly zero only at standstill.
Eigen::MatrixXd draw_commands(const VehicleOptions& o, std::mt19937_64& generator) {
  CommandOptions exact = o.commands;
  exact.input_quantum = 0.0;
  const Eigen::MatrixXd drawn = draw_inputs(exact, generator);
  const Eigen::RowVectorXd moves = (drawn.row(0).array() != 0.0 || drawn.row(1).array() != 0.0).cast<double>();
  const Eigen::RowVectorXd forward = 0.5 * (drawn.row(0) + drawn.row(1)) + o.forward_speed_m_s * moves;
  const Eigen::RowVectorXd turn = 0.5 * o.turn_scale * (drawn.row(1) - drawn.row(0));
  Eigen::MatrixXd command(2, drawn.cols());
  command << forward - turn, forward + turn;
  const double quantum = o.commands.input_quantum;
  if (quantum > 0.0) command = (command / quantum).array().round() * quantum;
  return command;
}

void resize(VehicleRun& run, Index samples, Index state_samples) {
  run.wheel_speed.resize(2, samples);
  run.truth.resize(3, state_samples);
  run.true_wheel.resize(2, state_samples);
  run.pose.resize(3, state_samples);
  run.friction.resize(state_samples);
  run.kind.resize(state_samples);
}

void note_truth(VehicleRun& run, Index j, const VehicleState& state, const Vehicle& vehicle, const Ground& ground) {
  using At = VehicleState;
  run.truth.col(j) << state[At::yaw_rate], state[At::vx], state[At::vy];
  run.true_wheel.col(j) << state[At::wheel_left], state[At::wheel_right];
  run.pose.col(j) << state[At::x], state[At::y], state[At::heading];
  run.friction(j) = vehicle.mean_friction(state);
  run.kind(j) = ground.kind_at(state[At::x], state[At::y]);
}

/// Advances from one event (a command or a sample of the states) to the next. Wheel speeds are sampled when a command
/// arrives.
void drive(VehicleRun& run, const VehicleOptions& o, const Ground& ground, VehicleState state) {
  const Vehicle vehicle(o.vehicle, ground);
  const double step_s = o.step_s > 0.0 ? o.step_s : Vehicle::default_step_s(o.vehicle, kinds_of(o));
  WheelCommand command;
  double now_s = 0.0;
  for (Index k = 0, j = 0; j < run.time_s.size();) {
    const double command_s = static_cast<double>(k) * o.dt_s;
    const bool commands = k < run.command.cols() && command_s <= run.time_s(j);
    const double next_s = commands ? command_s : run.time_s(j);
    vehicle.advance(state, command, next_s - now_s, step_s);
    now_s = next_s;
    if (commands) {
      run.wheel_speed.col(k) << state[VehicleState::wheel_left], state[VehicleState::wheel_right];
      command = {run.command(0, k), run.command(1, k)};
      ++k;
    } else {
      note_truth(run, j++, state, vehicle, ground);
    }
  }
}

/// Bias of the gyro at its samples: a random walk from the configured start.
Eigen::RowVectorXd gyro_bias(const VehicleOptions& o, Index samples, std::mt19937_64& generator) {
  Eigen::RowVectorXd bias = draw_noise(samples, o.sensors.gyro_bias_walk / std::sqrt(o.state_rate_hz), generator);
  bias(0) = o.sensors.gyro_bias;
  for (Index j = 1; j < samples; ++j) bias(j) += bias(j - 1);
  return bias;
}

void measure(VehicleRun& run, const VehicleOptions& o, std::mt19937_64& noise, std::mt19937_64& bias) {
  const SensorOptions& s = o.sensors;
  run.measured = run.truth.topRows(o.measured);
  run.measured.row(0) += gyro_bias(o, run.time_s.size(), bias);
  Eigen::VectorXd sd = Eigen::VectorXd::Constant(o.measured, s.speed_noise_sd);
  sd(0) = s.gyro_noise_density * std::sqrt(o.state_rate_hz);
  add_noise(run.measured, sd, {o.outlier_fraction, o.outlier_sd}, noise);
  if (s.wheel_quantum_m_s > 0.0)
    run.wheel_speed = (run.wheel_speed / s.wheel_quantum_m_s).array().round() * s.wheel_quantum_m_s;
  run.inputs_time_s =
      (Eigen::ArrayXd::LinSpaced(o.commands.samples, 0, static_cast<double>(o.commands.samples - 1)) * o.dt_s -
       s.lag_s) /
      (1.0 + s.drift);
}

VehicleRun make_run(const VehicleOptions& o, std::uint64_t seed, Index i) {
  // Each purpose has its own generator, so that changing the sensors does not change the drive and the ground.
  const auto index = static_cast<std::uint64_t>(i);
  const auto generator = [&](std::string_view use) { return make_generator(seed, use, index); };
  auto inputs = generator("simulate.inputs"), noise = generator("simulate.measurement"),
       bias = generator("simulate.gyro_bias"), heading = generator("simulate.heading");
  VehicleRun run;
  run.run = simulated_run_name(i, o.runs);
  run.role = i % 2 == 0 ? Role::train : Role::test;
  run.command = draw_commands(o, inputs);
  const double duration_s = static_cast<double>(o.commands.samples - 1) * o.dt_s;
  const Index state_samples = static_cast<Index>(std::ceil(duration_s * o.state_rate_hz)) + 2;
  run.time_s = Eigen::VectorXd::LinSpaced(state_samples, 0, static_cast<double>(state_samples - 1)) / o.state_rate_hz;
  resize(run, o.commands.samples, state_samples);
  const auto kinds = static_cast<Index>(o.friction.size());
  const Ground ground(kinds_of(o), o.patch_m, static_cast<int>((i / 2) % kinds),
                      derive_seed(seed, "simulate.ground", index));
  VehicleState start;
  start[VehicleState::x] = start[VehicleState::y] = 0.5 * o.patch_m;
  constexpr double turn = 2.0 * std::numbers::pi;
  start[VehicleState::heading] = turn * boost::random::uniform_01<double>()(heading);
  drive(run, o, ground, start);
  measure(run, o, noise, bias);
  return run;
}

}  // namespace

std::vector<VehicleRun> simulate_vehicle(const VehicleSimulationOptions& options, std::uint64_t seed) {
  check(options);
  std::vector<VehicleRun> runs(static_cast<std::size_t>(options.runs));
  tbb::parallel_for(std::size_t{0}, runs.size(),
                    [&](std::size_t i) { runs[i] = make_run(options, seed, static_cast<Index>(i)); });
  return runs;
}

}  // namespace modebank
