#include <fmt/format.h>

#include "app/config/option_builders.hpp"
#include "app/config/options/sections.hpp"

namespace modebank::app {
namespace {

std::vector<Option> only_for(SimulatedSystem system, std::vector<Option> options) {
  for (Option& entry : options) {
    entry.only_for = system;
    entry.help += fmt::format(" ({})", name_of(system));
  }
  return options;
}

std::vector<Option> common_options() {
  return {
      text("simulate.output", "a folder", "where the runs are written", MODEBANK_FIELD(simulate.output)),
      words("simulate.system", "switching linear system, or skid-steer robot on patches of ground",
            MODEBANK_FIELD(simulate.kind)),
      numeric("simulate.outlier_fraction", between(0, 1), "", "share of measurements with an outlier",
              MODEBANK_FIELD(simulate.system.outlier_fraction)),
      numeric("simulate.outlier_sd", at_least(0), "state unit", "size of outliers",
              MODEBANK_FIELD(simulate.system.outlier_sd)),
      words("simulate.input_law",
            "inputs redrawn every sample, held, or driven (steps, ramps, standstill, equal wheels)",
            MODEBANK_FIELD(simulate.system.input_law)),
      numeric("simulate.hold_samples", at_least(1), "samples", "mean length of a command",
              MODEBANK_FIELD(simulate.system.hold_samples)),
      numeric("simulate.input_amplitude", above(0), "input unit", "largest command",
              MODEBANK_FIELD(simulate.system.input_amplitude)),
      numeric("simulate.input_quantum", at_least(0), "input unit",
              "inputs (vehicle: commands) are multiples of this; 0: any value",
              MODEBANK_FIELD(simulate.system.input_quantum)),
      numeric("simulate.standstill_fraction", between(0, 1), "", "share of commands with all inputs zero (drive)",
              MODEBANK_FIELD(simulate.system.standstill_fraction)),
      numeric("simulate.equal_fraction", between(0, 1), "", "share of commands with all inputs equal (drive)",
              MODEBANK_FIELD(simulate.system.equal_fraction)),
      numeric("simulate.runs", between(1, 100'000), "", "number of runs", MODEBANK_FIELD(simulate.system.runs)),
      numeric("simulate.samples", between(2, 1e8), "", "samples per run", MODEBANK_FIELD(simulate.system.samples)),
      numeric("simulate.rate_hz", between(1e-6, 1e6), "Hz", "rate of commands and of the inputs file",
              MODEBANK_FIELD(simulate.rate_hz)),
      numeric("simulate.state_rate_hz", between(1e-6, 1e6), "Hz",
              "rate of the states file; for a linear system a multiple of rate_hz keeps every measurement",
              MODEBANK_FIELD(simulate.state_rate_hz)),
  };
}

std::vector<Option> linear_options() {
  return only_for(
      SimulatedSystem::linear,
      {
          numeric("simulate.modes", any(), "", "parameters [A B (c)] row by row, one set per mode, sets separated by |",
                  MODEBANK_FIELD(simulate.system.modes)),
          numeric("simulate.process_sd", each(at_least(0)), "state unit", "process noise per mode, or one for all",
                  MODEBANK_FIELD(simulate.system.process_sd)),
          numeric("simulate.measurement_sd", at_least(0), "state unit", "measurement noise",
                  MODEBANK_FIELD(simulate.system.measurement_sd)),
          numeric("simulate.transition", each(between(0, 1)), "",
                  "mode transition matrix, rows separated by |; empty: from dwell_samples",
                  MODEBANK_FIELD(simulate.system.transition)),
          numeric("simulate.dwell_samples", at_least(0), "samples",
                  "mean stay in a mode; 0: each run stays in one mode", MODEBANK_FIELD(simulate.system.dwell_samples)),
      });
}

std::vector<Option> vehicle_options() {
  return only_for(
      SimulatedSystem::vehicle,
      {
          numeric("simulate.mass", above(0), "kg", "mass", MODEBANK_FIELD(simulate.vehicle.vehicle.mass_kg)),
          numeric("simulate.yaw_inertia", above(0), "kg m^2", "moment of inertia about the vertical axis",
                  MODEBANK_FIELD(simulate.vehicle.vehicle.yaw_inertia_kg_m2)),
          numeric("simulate.track", above(0), "m", "between left and right wheels",
                  MODEBANK_FIELD(simulate.vehicle.vehicle.track_m)),
          numeric("simulate.wheelbase", at_least(0), "m", "between front and rear axle",
                  MODEBANK_FIELD(simulate.vehicle.vehicle.wheelbase_m)),
          numeric("simulate.contact_length", above(0), "m", "length of a tyre's contact patch",
                  MODEBANK_FIELD(simulate.vehicle.vehicle.contact_m)),
          numeric("simulate.slip_speed", above(0), "m/s",
                  "slip is relative to wheel speed plus this; small: sharper stick and slip, shorter steps",
                  MODEBANK_FIELD(simulate.vehicle.vehicle.slip_speed_m_s)),
          numeric("simulate.drive_mass", above(0), "kg", "inertia of one side's wheels and gears, at the rim",
                  MODEBANK_FIELD(simulate.vehicle.vehicle.drive_mass_kg)),
          numeric("simulate.drive_time", above(0), "s", "time constant of the wheel speed loop",
                  MODEBANK_FIELD(simulate.vehicle.vehicle.drive_time_s)),
          numeric("simulate.drive_force", above(0), "N", "largest force of one side's motor at the rim",
                  MODEBANK_FIELD(simulate.vehicle.vehicle.drive_force_N)),
          numeric("simulate.friction", each(above(0)), "", "friction coefficient of each kind of ground",
                  MODEBANK_FIELD(simulate.vehicle.friction)),
          text("simulate.ground_names", "words", "column ground of the states file; empty: none, mode numbers them",
               MODEBANK_FIELD(simulate.ground_names)),
          numeric("simulate.shear", each(above(0)), "m",
                  "shear deformation modulus of each kind of ground, or one for all",
                  MODEBANK_FIELD(simulate.vehicle.shear_m)),
          numeric("simulate.resistance", each(at_least(0)), "",
                  "motion resistance over weight on each kind of ground, or one for all",
                  MODEBANK_FIELD(simulate.vehicle.resistance)),
          numeric("simulate.patch", at_least(0), "m",
                  "side of the square tiles whose ground is drawn; 0: each run stays on one kind",
                  MODEBANK_FIELD(simulate.vehicle.patch_m)),
          numeric("simulate.forward_speed", any(), "m/s", "added to both wheels of every command but standstill",
                  MODEBANK_FIELD(simulate.vehicle.forward_speed_m_s)),
          numeric("simulate.turn_scale", at_least(0), "", "factor on the turning part of commands",
                  MODEBANK_FIELD(simulate.vehicle.turn_scale)),
          numeric("simulate.gyro_noise_density", at_least(0), "rad/s/sqrt(Hz)",
                  "a sample's standard deviation is this times sqrt(state_rate_hz)",
                  MODEBANK_FIELD(simulate.vehicle.sensors.gyro_noise_density)),
          numeric("simulate.gyro_bias", any(), "rad/s", "bias at the start of a run",
                  MODEBANK_FIELD(simulate.vehicle.sensors.gyro_bias)),
          numeric("simulate.gyro_bias_walk", at_least(0), "rad/s/sqrt(s)", "random walk of the bias",
                  MODEBANK_FIELD(simulate.vehicle.sensors.gyro_bias_walk)),
          numeric(
              "simulate.speed_noise_sd", at_least(0), "m/s",
              "noise of forward and sideways speed, which are measured when data.state names them after the yaw rate",
              MODEBANK_FIELD(simulate.vehicle.sensors.speed_noise_sd)),
          numeric("simulate.wheel_quantum", at_least(0), "m/s", "wheel speeds are multiples of this; 0: exact",
                  MODEBANK_FIELD(simulate.vehicle.sensors.wheel_quantum_m_s)),
          numeric(
              "simulate.lag_s", any(), "s",
              "the inputs file's times are this much early (negative: late): data.lag_s with the same value undoes it",
              MODEBANK_FIELD(simulate.vehicle.sensors.lag_s)),
          numeric("simulate.drift", between(-0.5, 0.5), "s/s",
                  "true time = t + lag_s + drift * t for a time t of the inputs file",
                  MODEBANK_FIELD(simulate.vehicle.sensors.drift)),
          numeric("simulate.step", at_least(0), "s", "integration step; 0: from the stiffest ground",
                  MODEBANK_FIELD(simulate.vehicle.step_s)),
      });
}

}  // namespace

std::vector<Option> simulate_options() {
  std::vector<Option> all;
  for (auto part : {common_options, linear_options, vehicle_options})
    for (Option& entry : part()) all.push_back(std::move(entry));
  return all;
}

}  // namespace modebank::app
