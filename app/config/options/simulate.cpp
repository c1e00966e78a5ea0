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

std::vector<Option> common_parameters() {
  return {
      words("system.kind", "kind of system: a switching linear system, or a skid-steer robot on patches of ground",
            MODEBANK_FIELD(simulate.kind))
          .touch("always"),
      text("system.ground_names", "words",
           "names in the column ground of the simulated files; empty: no such column (the column mode has the ground's "
           "number)",
           MODEBANK_FIELD(simulate.ground_names))
          .touch("when modes shall be named after the grounds"),
      numeric("system.outlier_fraction", between(0, 1), "", "share of measurements with an outlier",
              MODEBANK_FIELD(simulate.system.outlier_fraction))
          .touch("to see what a robust loss does: 0.01 to 0.1"),
      numeric("system.outlier_sd", at_least(0), "state unit", "standard deviation of outliers",
              MODEBANK_FIELD(simulate.system.outlier_sd))
          .touch("with outlier_fraction: about ten times the noise"),
      words("system.input_law",
            "law of the inputs: drawn anew at every sample, held, or driven (steps, ramps, standstill, equal wheels)",
            MODEBANK_FIELD(simulate.system.input_law))
          .touch("white for the best excitation, drive for what robots do"),
      numeric("system.hold_samples", at_least(1), "samples", "mean length of a command",
              MODEBANK_FIELD(simulate.system.hold_samples))
          .touch("longer, to see the effect of poor excitation"),
      numeric("system.input_amplitude", above(0), "input unit", "largest command",
              MODEBANK_FIELD(simulate.system.input_amplitude))
          .touch("when your system's inputs have another size"),
      numeric("system.input_quantum", at_least(0), "input unit",
              "step of the inputs (vehicle: of the commands), which are multiples of it; 0: any value",
              MODEBANK_FIELD(simulate.system.input_quantum))
          .touch("when your commands come in steps"),
      numeric("system.standstill_fraction", between(0, 1), "", "share of commands with all inputs zero (drive)",
              MODEBANK_FIELD(simulate.system.standstill_fraction))
          .touch("as in your logs; a large share leaves windows rank deficient"),
      numeric("system.equal_fraction", between(0, 1), "", "share of commands with all inputs equal (drive)",
              MODEBANK_FIELD(simulate.system.equal_fraction))
          .touch("as in your logs; much straight driving leaves the turning motion little excited"),
  };
}

std::vector<Option> linear_parameters() {
  return {
      numeric("system.modes", any(), "", "parameters of each mode: [A B (c)] row by row, modes separated by |",
              MODEBANK_FIELD(simulate.system.modes))
          .touch("always with linear"),
      numeric("system.process_sd", each(at_least(0)), "state unit",
              "standard deviation of the process noise, one per mode or one for all",
              MODEBANK_FIELD(simulate.system.process_sd))
          .touch("always with linear"),
      numeric("system.measurement_sd", at_least(0), "state unit", "standard deviation of the measurement noise",
              MODEBANK_FIELD(simulate.system.measurement_sd))
          .touch("when your sensor's noise is as large as the motion's"),
      numeric("system.transition", each(between(0, 1)), "",
              "mode transition matrix, rows separated by |; empty: made from dwell_samples",
              MODEBANK_FIELD(simulate.system.transition))
          .touch("when you know the matrix; else set dwell_samples"),
      numeric("system.dwell_samples", at_least(0), "samples", "mean duration of a mode; 0: each run stays in one mode",
              MODEBANK_FIELD(simulate.system.dwell_samples))
          .touch("for modes that switch within a run: a few windows long, so that they can be found"),
  };
}

std::vector<Option> vehicle_parameters() {
  return {
      numeric("system.mass", above(0), "kg", "mass", MODEBANK_FIELD(simulate.vehicle.vehicle.mass_kg))
          .touch("for your vehicle"),
      numeric("system.yaw_inertia", above(0), "kg m^2", "moment of inertia about the vertical axis",
              MODEBANK_FIELD(simulate.vehicle.vehicle.yaw_inertia_kg_m2))
          .touch("for your vehicle"),
      numeric("system.track", above(0), "m", "distance between left and right wheels",
              MODEBANK_FIELD(simulate.vehicle.vehicle.track_m))
          .touch("for your vehicle"),
      numeric("system.wheelbase", at_least(0), "m", "distance between front and rear axle",
              MODEBANK_FIELD(simulate.vehicle.vehicle.wheelbase_m))
          .touch("for your vehicle; 0: it turns without scrubbing"),
      numeric("system.contact_length", above(0), "m", "length of a tyre's contact patch",
              MODEBANK_FIELD(simulate.vehicle.vehicle.contact_m))
          .touch("when you know your tyres"),
      numeric("system.slip_speed", above(0), "m/s",
              "speed added to the wheel speed in the slip ratio's denominator; a smaller value makes stick and slip "
              "sharper and integration steps shorter",
              MODEBANK_FIELD(simulate.vehicle.vehicle.slip_speed_m_s))
          .touch("rarely: to study stick and slip near standstill"),
      numeric("system.drive_mass", above(0), "kg", "inertia of one side's wheels and gears, at the rim",
              MODEBANK_FIELD(simulate.vehicle.vehicle.drive_mass_kg))
          .touch("when you know your drive"),
      numeric("system.drive_time", above(0), "s", "time constant of the wheel speed loop",
              MODEBANK_FIELD(simulate.vehicle.vehicle.drive_time_s))
          .touch("for your vehicle: from a step response of its speed controller"),
      numeric("system.drive_force", above(0), "N", "largest force of one side's motor at the rim",
              MODEBANK_FIELD(simulate.vehicle.vehicle.drive_force_N))
          .touch("for your vehicle; on grip it limits the acceleration of the wheels"),
      numeric("system.friction", each(above(0)), "", "friction coefficient of each kind of ground",
              MODEBANK_FIELD(simulate.vehicle.friction))
          .touch("for your grounds: 0.05 to 0.1 is ice, 0.6 dry floor"),
      numeric("system.shear", each(above(0)), "m", "shear deformation modulus of each kind of ground, or one for all",
              MODEBANK_FIELD(simulate.vehicle.shear_m))
          .touch("rarely: when grounds shall differ in stiffness, too"),
      numeric("system.resistance", each(at_least(0)), "",
              "motion resistance over weight on each kind of ground, or one for all",
              MODEBANK_FIELD(simulate.vehicle.resistance))
          .touch("higher for soft ground"),
      numeric("system.patch", at_least(0), "m",
              "side of the square tiles, whose ground is random; 0: each run stays on one kind of ground",
              MODEBANK_FIELD(simulate.vehicle.patch_m))
          .touch("0, for one ground per run; larger, for longer stays on each"),
      numeric("system.forward_speed", any(), "m/s", "speed added to both wheels in every command except standstill",
              MODEBANK_FIELD(simulate.vehicle.forward_speed_m_s))
          .touch("0, for turning on the spot alone"),
      numeric("system.turn_scale", at_least(0), "", "factor on the turning part of commands",
              MODEBANK_FIELD(simulate.vehicle.turn_scale))
          .touch("below 1, for a driver who turns gently"),
      numeric("system.gyro_noise_density", at_least(0), "rad/s/sqrt(Hz)",
              "noise density of the gyro; a sample's standard deviation is this times sqrt(state_rate_hz)",
              MODEBANK_FIELD(simulate.vehicle.sensors.gyro_noise_density))
          .touch("from your gyro's data sheet"),
      numeric("system.gyro_bias", any(), "rad/s", "gyro bias at the start of a run",
              MODEBANK_FIELD(simulate.vehicle.sensors.gyro_bias))
          .touch("from your gyro's data sheet; window.intercept then estimates its effect"),
      numeric("system.gyro_bias_walk", at_least(0), "rad/s/sqrt(s)", "random walk of the gyro bias",
              MODEBANK_FIELD(simulate.vehicle.sensors.gyro_bias_walk))
          .touch("from your gyro's data sheet"),
      numeric("system.speed_noise_sd", at_least(0), "m/s",
              "standard deviation of the measured forward and sideways speed; data.state names them after the yaw rate",
              MODEBANK_FIELD(simulate.vehicle.sensors.speed_noise_sd))
          .touch("when data.state names speeds, too"),
      numeric("system.wheel_quantum", at_least(0), "m/s",
              "step of the wheel speeds, which are multiples of it; 0: exact",
              MODEBANK_FIELD(simulate.vehicle.sensors.wheel_quantum_m_s))
          .touch("for your encoders"),
      numeric("system.step", at_least(0), "s", "integration step; 0: chosen for the stiffest ground",
              MODEBANK_FIELD(simulate.vehicle.step_s))
          .touch("rarely: to check the integration, whose result must not change with half the step"),
  };
}

}  // namespace

std::vector<Option> simulate_options() {
  std::vector<Option> all{
      text("simulate.output", "a folder", "folder to write the runs to", MODEBANK_FIELD(simulate.output))
          .touch("for every simulation", std::nullopt, basic),
      text("simulate.system", "a name, or a file",
           "what is simulated: husky_ice, three_grips, two_grounds, or a file with a section [system]",
           MODEBANK_FIELD(simulate.name))
          .touch("for a system of your own: copy one of configs/systems and change it", std::nullopt, basic),
      numeric("simulate.runs", between(1, 100'000), "", "number of runs", MODEBANK_FIELD(simulate.system.runs))
          .touch("more, for smaller standard errors; at least 8 for evidence", std::nullopt, basic),
      numeric("simulate.samples", between(2, 1e8), "", "samples per run", MODEBANK_FIELD(simulate.system.samples))
          .touch("more, when runs are too short for their modes", std::nullopt, basic),
      numeric("simulate.rate_hz", between(1e-6, 1e6), "Hz", "rate of commands and of the inputs file",
              MODEBANK_FIELD(simulate.rate_hz))
          .touch("as in your logs"),
      numeric("simulate.state_rate_hz", between(1e-6, 1e6), "Hz",
              "rate of the states file; for a linear system a multiple of rate_hz keeps every measurement",
              MODEBANK_FIELD(simulate.state_rate_hz))
          .touch("as in your logs; equal to rate_hz where both come together"),
  };
  for (Option& entry :
       only_for(SimulatedSystem::vehicle,
                {numeric("simulate.lag_s", any(), "s",
                         "time by which stamps of the inputs are early (negative: late); data.lag_s with the same "
                         "value corrects it",
                         MODEBANK_FIELD(simulate.vehicle.sensors.lag_s))
                     .touch("to see whether lag_s = auto finds it"),
                 numeric("simulate.drift", between(-0.5, 0.5), "s/s",
                         "clock drift of the inputs file: its time t is the true time t + lag_s + drift * t",
                         MODEBANK_FIELD(simulate.vehicle.sensors.drift))
                     .touch("to see whether lag_s = auto finds it")}))
    all.push_back(std::move(entry));
  return all;
}

const std::vector<Option>& system_parameters() {
  static const std::vector<Option> table = [] {
    std::vector<Option> all = common_parameters();
    for (Option& entry : only_for(SimulatedSystem::linear, linear_parameters())) all.push_back(std::move(entry));
    for (Option& entry : only_for(SimulatedSystem::vehicle, vehicle_parameters())) all.push_back(std::move(entry));
    return all;
  }();
  return table;
}

}  // namespace modebank::app
