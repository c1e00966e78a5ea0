
#include "app/config/option_builders.hpp"
#include "app/config/options/sections.hpp"

namespace modebank::app {
namespace {

std::vector<Option> mode_parameters() {
  return {
      numeric("system.rate_hz", between(1e-6, 1e6), "Hz", "rate of commands and of the inputs file",
              MODEBANK_FIELD(simulate.rate_hz))
          .touch("as in your logs"),
      numeric("system.state_rate_hz", between(1e-6, 1e6), "Hz",
              "rate of the states file; a multiple of rate_hz keeps every measurement",
              MODEBANK_FIELD(simulate.state_rate_hz))
          .touch("as in your logs; equal to rate_hz where both come together"),
      numeric("system.modes", any(), "", "parameters of each mode: [A B (c)] row by row, modes separated by |",
              MODEBANK_FIELD(simulate.system.modes))
          .touch("always"),
      numeric("system.process_sd", each(at_least(0)), "state unit",
              "standard deviation of the process noise, one per mode or one for all",
              MODEBANK_FIELD(simulate.system.process_sd))
          .touch("always"),
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
  };
}

std::vector<Option> input_parameters() {
  return {
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
              "step of the inputs, which are multiples of it; 0: any value",
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

}  // namespace

std::vector<Option> simulate_options() {
  return {
      text("simulate.output", "a folder", "folder to write the runs to", MODEBANK_FIELD(simulate.output))
          .touch("for every simulation", std::nullopt, basic),
      text("simulate.system", "a name, or a file",
           "what is simulated: three_grips, two_grounds, or a file with a section [system]",
           MODEBANK_FIELD(simulate.name))
          .touch("for a system of your own: copy one of configs/systems and change it", std::nullopt, basic),
      numeric("simulate.runs", between(1, 100'000), "", "number of runs", MODEBANK_FIELD(simulate.system.runs))
          .touch("more, for smaller standard errors; at least 8 for evidence", std::nullopt, basic),
      numeric("simulate.samples", between(2, 1e8), "", "samples per run", MODEBANK_FIELD(simulate.system.samples))
          .touch("more, when runs are too short for their modes", std::nullopt, basic),
  };
}

const std::vector<Option>& system_parameters() {
  static const std::vector<Option> table = [] {
    std::vector<Option> all = mode_parameters();
    for (Option& entry : input_parameters()) all.push_back(std::move(entry));
    return all;
  }();
  return table;
}

}  // namespace modebank::app
