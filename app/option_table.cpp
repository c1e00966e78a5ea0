#include "app/option_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Core>
#include <optional>
#include <stdexcept>
#include <type_traits>

#include "app/option_text.hpp"
#include "ident/motion_model.hpp"

namespace modebank::app {
namespace {

/// Allowed numbers, in words and as a test.
struct Range {
  std::string text;
  std::function<bool(double)> contains;
};

Range any() {
  return {"a number", [](double) { return true; }};
}
Range at_least(double low) {
  return {fmt::format(">= {}", low), [low](double v) { return v >= low; }};
}
Range above(double low) {
  return {fmt::format("> {}", low), [low](double v) { return v > low; }};
}
Range between(double low, double high) {
  return {fmt::format("{} to {}", low, high), [low, high](double v) { return v >= low && v <= high; }};
}
Range inside(double low, double high) {
  return {fmt::format("above {} and below {}", low, high), [low, high](double v) { return v > low && v < high; }};
}
Range each(Range range) {
  range.text = "each " + range.text;
  return range;
}

template <class T>
requires std::is_arithmetic_v<T>
bool in_range(const Range& range, T value) { return range.contains(static_cast<double>(value)); }
bool in_range(const Range& range, const std::optional<double>& value) { return !value || range.contains(*value); }
bool in_range(const Range& range, const Eigen::MatrixXd& values) {
  return std::all_of(values.reshaped().begin(), values.reshaped().end(), range.contains);
}
template <class T>
bool in_range(const Range& range, const std::vector<T>& values) {
  return std::all_of(values.begin(), values.end(), [&range](const T& value) { return in_range(range, value); });
}

/// `field` maps a Config to the value, so reading and writing go through one expression.
template <class Field>
Option option(std::string key, std::string range, std::string unit, std::string help, Field field) {
  return {std::move(key),
          std::move(range),
          std::move(unit),
          std::move(help),
          [field](Config& config, const std::string& text) {
            std::decay_t<decltype(field(config))> value = field(config);
            parse_value(text, value);
            field(config) = value;
          },
          [field](const Config& config) {
            Config copy = config;
            return format_value(field(copy));
          },
          {}};
}

template <class Field>
Option numeric(std::string key, const Range& range, std::string unit, std::string help, Field field) {
  Option result = option(std::move(key), range.text, std::move(unit), std::move(help), field);
  result.set = [set = result.set, range, field](Config& config, const std::string& text) {
    Config candidate = config;
    set(candidate, text);
    if (!in_range(range, field(candidate))) throw std::invalid_argument("is out of range");
    config = candidate;
  };
  return result;
}

template <class Field>
Option words(std::string key, std::string help, Field field) {
  using E = std::decay_t<decltype(field(std::declval<Config&>()))>;
  return option(std::move(key), words_of<E>(), "", std::move(help), field);
}

template <class Field>
Option flag(std::string key, std::string help, Field field) {
  return option(std::move(key), "true | false", "", std::move(help), field);
}

template <class Field>
Option text(std::string key, std::string what, std::string help, Field field) {
  return option(std::move(key), std::move(what), "", std::move(help), field);
}

#define FIELD(expression) \
  [](Config & c) -> auto& { return c.expression; }

/// A number, or a word in its place.
Option lag_option() {
  Option result = numeric("data.lag_s", any(), "s",
                          "inputs act this much later (negative: earlier); auto estimates lag and clock drift per run "
                          "on the training runs and applies them if cross-validation among these gains",
                          FIELD(data.lag_s));
  result.range = "a number or auto";
  result.set = [set = result.set](Config& config, const std::string& text) {
    if (text != "auto") set(config, text);
    config.data.lag_auto = text == "auto";
    if (config.data.lag_auto) config.data.lag_s = 0.0;
  };
  result.get = [get = result.get](const Config& config) { return config.data.lag_auto ? "auto" : get(config); };
  return result;
}

std::vector<Option> data_options() {
  return {
      text("data.root", "a folder", "prefix of relative data paths; empty: $MODEBANK_DATA, else this file's folder",
           FIELD(data.root)),
      text("data.inputs", "a path with at most one *", "one file per run; the part matched by * names the run",
           FIELD(data.inputs)),
      text("data.states", "a path with at most one *",
           "the runs' states files; empty: states are columns of the inputs files", FIELD(data.states)),
      text("data.state", "column names", "measured states", FIELD(data.state)),
      text("data.input", "column names", "inputs", FIELD(data.input)),
      text("data.truth", "column names", "true states, one per state, where known; empty: none", FIELD(data.truth)),
      text("data.weight", "a column name",
           "sample weights >= 0 of the transitions that end in each sample, 0 leaves one out; empty: all equal",
           FIELD(data.weight)),
      text("data.state_unit", "units", "one per state, or one for all; written to the archive and the plots",
           FIELD(data.state_unit)),
      text("data.input_unit", "units", "one per input, or one for all", FIELD(data.input_unit)),
      text("data.time", "a column name", "time in seconds", FIELD(data.time)),
      words("data.join", "how states join the inputs: interpolated at the inputs' times, or row by row",
            FIELD(data.join)),
      text("data.run", "a column name", "column whose value separates runs inside one file; empty: one run per file",
           FIELD(data.run)),
      numeric("data.rate_hz", at_least(0), "Hz", "0: the inputs' own times; else resample (states linear, inputs held)",
              FIELD(data.rate_hz)),
      lag_option(),
      numeric("data.lag_range_s", above(0), "s",
              "lags from minus to plus this are searched by lag_s = auto and by check", FIELD(data.lag_range_s)),
      words("data.missing",
            "NaN, infinite or empty values: an error; a gap that splits the run; or a missing state is a step of "
            "prediction only, a missing input the last known one",
            FIELD(data.missing)),
      words("data.disorder",
            "time going backwards or repeated: an error, or sort the rows and keep the first of each time",
            FIELD(data.disorder)),
      text("data.train", "run names", "training runs; empty: positions 0, 2, 4, ... in name order", FIELD(data.train)),
      text("data.test", "run names", "held-out runs; empty: all that do not train", FIELD(data.test)),
  };
}

/// linear, varx and every motion model that is compiled in.
Option model_option() {
  std::vector<std::string> models{"linear", "varx"};
  for (const std::string& model : motion_model_names()) models.push_back(model);
  Option result = text("window.model", fmt::format("{}", fmt::join(models, " | ")),
                       "A x + B u; with lags; or a motion model of ident/models", FIELD(window.model));
  result.set = [set = result.set, models](Config& config, const std::string& value) {
    if (std::find(models.begin(), models.end(), value) == models.end())
      throw std::invalid_argument("is none of its words");
    set(config, value);
  };
  return result;
}

std::vector<Option> window_options() {
  return {
      model_option(),
      numeric("window.state_lags", between(1, 100), "samples", "varx: states x[k], x[k-1], ... that predict x[k+1]",
              FIELD(window.state_lags)),
      numeric("window.input_lags", between(1, 100), "samples", "varx: input samples that act on one transition",
              FIELD(window.input_lags)),
      numeric("window.input_delay", between(0, 1000), "samples",
              "varx: from an input to its first effect; 0: u[k+1] acts on x[k+1]", FIELD(window.input_delay)),
      numeric("window.wheel_radius_m", above(0), "m",
              "icr and slip: turns wheel speeds in rad/s into m/s; 1 for inputs that are m/s",
              FIELD(window.wheel_radius_m)),
      words("window.residual",
            "each sample predicted from the one before, or the window simulated from its first sample (estimated)",
            FIELD(window.residual)),
      numeric("window.length", between(1, 1e6), "transitions", "length of a window", FIELD(window.length)),
      numeric("window.step", between(1, 1e6), "transitions", "from one window's start to the next", FIELD(window.step)),
      words("window.loss", "robust loss of a sample's residual", FIELD(window.loss)),
      numeric("window.loss_scale", at_least(0), "sigma", "where the loss bends; 0: 95 % efficiency under normal noise",
              FIELD(window.loss_scale)),
      words("window.scale", "residual scale sigma: of each window, of its run, or window.sigma", FIELD(window.scale)),
      numeric("window.sigma", at_least(0), "state unit", "residual standard deviation for scale = fixed",
              FIELD(window.sigma)),
      words("window.prior", "Gaussian prior on a window's parameters", FIELD(window.prior)),
      numeric("window.prior_sd", each(above(0)), "parameter unit",
              "the prior's standard deviations, one per parameter or one for all; empty: 3 x the spread of full-rank "
              "windows",
              FIELD(window.prior_sd)),
      flag("window.intercept", "estimate a constant term c", FIELD(window.intercept)),
      words("window.covariance", "covariance of a window's parameters: M-estimator or HC3 sandwich",
            FIELD(window.covariance)),
      words("window.solver",
            "who minimises: Ceres window by window, the batch solver for linear models of one state, or whichever can",
            FIELD(window.solver)),
      numeric("window.max_iterations", between(1, 1e5), "", "limit of the minimiser", FIELD(window.max_iterations)),
  };
}

std::vector<Option> mixture_options() {
  return {
      numeric("mixture.components", each(at_least(1)), "", "a number, a range such as 1..12, or a list",
              FIELD(mixture.selection.components)),
      words("mixture.covariance", "shape of the components", FIELD(mixture.selection.em.covariance)),
      words("mixture.criterion", "chooses the number of components", FIELD(mixture.selection.criterion)),
      words("mixture.features", "what is clustered", FIELD(mixture.features)),
      words("mixture.windows", "which windows are clustered; automatic: all with a prior, else full_rank",
            FIELD(mixture.windows)),
      words("mixture.straddling", "windows that straddle a switch of mode", FIELD(mixture.straddling)),
      numeric("mixture.restarts", between(1, 10'000), "", "independent starts per candidate",
              FIELD(mixture.selection.em.restarts)),
      numeric("mixture.tolerance", above(0), "nats/window", "stop when the mean log-likelihood gains less",
              FIELD(mixture.selection.em.tolerance)),
      numeric("mixture.max_iterations", between(1, 1e6), "", "limit of each EM run",
              FIELD(mixture.selection.em.max_iterations)),
      numeric("mixture.covariance_floor", between(0, 1), "feature variance", "smallest variance of a component",
              FIELD(mixture.selection.em.covariance_floor)),
  };
}

std::vector<Option> bank_options() {
  return {
      words("bank.theta", "a mode's parameters: pooled least squares, or the component's mean", FIELD(bank.theta)),
      words("bank.noise", "process noise Q", FIELD(bank.noise)),
      words("bank.transition", "transition matrix from window labels, or bank.stay", FIELD(bank.transition)),
      numeric("bank.stay", inside(0, 1), "", "probability to stay in a mode, for transition = stay", FIELD(bank.stay)),
      numeric("bank.process_variance", above(0), "state unit^2", "Q for noise = fixed", FIELD(bank.process_variance)),
      numeric("bank.measurement_variance", above(0), "state unit^2", "R; empty: the baseline's",
              FIELD(bank.measurement_variance)),
      flag("bank.screen", "leave unstable and starved modes out of the bank", FIELD(bank.screen)),
  };
}

std::vector<Option> other_options() {
  return {
      words("filter.variant", "multiple-model filter", FIELD(filter.variant)),
      flag("filter.parameter_noise", "add the modes' parameter spread to Q", FIELD(filter.parameter_noise)),
      words("filter.time_steps",
            "a longer time between samples: as many prediction steps as fit, the input held; or one step always",
            FIELD(filter.time_steps)),
      numeric("filter.horizon", each(between(1, 10'000)), "samples",
              "predictions this far ahead are scored, too: a number, a range such as 1..10, or a list; 1: the summary "
              "alone",
              FIELD(scoring.horizon)),
      flag("filter.smooth", "smoothed states and the most probable sequence of modes, too", FIELD(scoring.smooth)),
      text("archive.output", "a path", "archive to write; empty: this file's name with .h5, in the current folder",
           FIELD(archive.output)),
      text("archive.input", "an archive", "supplies the earlier stages of identify, cluster and evaluate",
           FIELD(archive.input)),
      text("archive.bank", "an archive", "evaluate: its banks are run instead of learning new ones",
           FIELD(archive.bank)),
      numeric("job.threads", between(0, 1024), "", "0: all cores; never changes a number", FIELD(job.threads)),
      option("job.seed", "a whole number >= 0", "", "the one seed; every use of randomness derives from it",
             FIELD(job.seed)),
  };
}

std::vector<Option> track_options() {
  return {
      words("track.filter", "which of the archive's filters runs", FIELD(track.filter)),
      words("track.format", "of lines in and out: CSV under a header, or a JSON object each; auto: by the first line",
            FIELD(track.format)),
      numeric("track.level", inside(0, 1), "", "probability of the interval about the prediction", FIELD(track.level)),
      numeric("track.alarm", inside(0, 1), "",
              "alarm when a measurement lies further out than this share of a true filter's would", FIELD(track.alarm)),
      text("track.checkpoint", "a path", "where the filter's state is kept at the end of the input or on SIGINT",
           FIELD(track.checkpoint)),
      numeric("track.checkpoint_interval", at_least(0), "samples", "and this often; 0: at the end only",
              FIELD(track.checkpoint_interval)),
      text("track.resume", "a checkpoint", "go on from there", FIELD(track.resume)),
  };
}

std::vector<Option> only_for(SimulatedSystem system, std::vector<Option> options) {
  for (Option& entry : options) {
    entry.only_for = system;
    entry.help += fmt::format(" ({})", name_of(system));
  }
  return options;
}

std::vector<Option> simulate_options() {
  return {
      text("simulate.output", "a folder", "where the runs are written", FIELD(simulate.output)),
      words("simulate.system", "switching linear system, or skid-steer robot on patches of ground",
            FIELD(simulate.kind)),
      numeric("simulate.outlier_fraction", between(0, 1), "", "share of measurements with an outlier",
              FIELD(simulate.system.outlier_fraction)),
      numeric("simulate.outlier_sd", at_least(0), "state unit", "size of outliers", FIELD(simulate.system.outlier_sd)),
      words("simulate.input_law",
            "inputs redrawn every sample, held, or driven (steps, ramps, standstill, equal wheels)",
            FIELD(simulate.system.input_law)),
      numeric("simulate.hold_samples", at_least(1), "samples", "mean length of a command",
              FIELD(simulate.system.hold_samples)),
      numeric("simulate.input_amplitude", above(0), "input unit", "largest command",
              FIELD(simulate.system.input_amplitude)),
      numeric("simulate.input_quantum", at_least(0), "input unit",
              "inputs (vehicle: commands) are multiples of this; 0: any value", FIELD(simulate.system.input_quantum)),
      numeric("simulate.standstill_fraction", between(0, 1), "", "share of commands with all inputs zero (drive)",
              FIELD(simulate.system.standstill_fraction)),
      numeric("simulate.equal_fraction", between(0, 1), "", "share of commands with all inputs equal (drive)",
              FIELD(simulate.system.equal_fraction)),
      numeric("simulate.runs", between(1, 100'000), "", "number of runs", FIELD(simulate.system.runs)),
      numeric("simulate.samples", between(2, 1e8), "", "samples per run", FIELD(simulate.system.samples)),
      numeric("simulate.rate_hz", between(1e-6, 1e6), "Hz", "rate of commands and of the inputs file",
              FIELD(simulate.rate_hz)),
      numeric("simulate.state_rate_hz", between(1e-6, 1e6), "Hz",
              "rate of the states file; for a linear system a multiple of rate_hz keeps every measurement",
              FIELD(simulate.state_rate_hz)),
  };
}

std::vector<Option> simulate_linear_options() {
  return only_for(
      SimulatedSystem::linear,
      {
          numeric("simulate.modes", any(), "", "parameters [A B (c)] row by row, one set per mode, sets separated by |",
                  FIELD(simulate.system.modes)),
          numeric("simulate.process_sd", each(at_least(0)), "state unit", "process noise per mode, or one for all",
                  FIELD(simulate.system.process_sd)),
          numeric("simulate.measurement_sd", at_least(0), "state unit", "measurement noise",
                  FIELD(simulate.system.measurement_sd)),
          numeric("simulate.transition", each(between(0, 1)), "",
                  "mode transition matrix, rows separated by |; empty: from dwell_samples",
                  FIELD(simulate.system.transition)),
          numeric("simulate.dwell_samples", at_least(0), "samples",
                  "mean stay in a mode; 0: each run stays in one mode", FIELD(simulate.system.dwell_samples)),
      });
}

std::vector<Option> simulate_robot_options() {
  return only_for(
      SimulatedSystem::vehicle,
      {
          numeric("simulate.mass", above(0), "kg", "mass", FIELD(simulate.vehicle.vehicle.mass_kg)),
          numeric("simulate.yaw_inertia", above(0), "kg m^2", "moment of inertia about the vertical axis",
                  FIELD(simulate.vehicle.vehicle.yaw_inertia_kg_m2)),
          numeric("simulate.track", above(0), "m", "between left and right wheels",
                  FIELD(simulate.vehicle.vehicle.track_m)),
          numeric("simulate.wheelbase", at_least(0), "m", "between front and rear axle",
                  FIELD(simulate.vehicle.vehicle.wheelbase_m)),
          numeric("simulate.contact_length", above(0), "m", "length of a tyre's contact patch",
                  FIELD(simulate.vehicle.vehicle.contact_m)),
          numeric("simulate.slip_speed", above(0), "m/s",
                  "slip is relative to wheel speed plus this; small: sharper stick and slip, shorter steps",
                  FIELD(simulate.vehicle.vehicle.slip_speed_m_s)),
          numeric("simulate.drive_mass", above(0), "kg", "inertia of one side's wheels and gears, at the rim",
                  FIELD(simulate.vehicle.vehicle.drive_mass_kg)),
          numeric("simulate.drive_time", above(0), "s", "time constant of the wheel speed loop",
                  FIELD(simulate.vehicle.vehicle.drive_time_s)),
          numeric("simulate.drive_force", above(0), "N", "largest force of one side's motor at the rim",
                  FIELD(simulate.vehicle.vehicle.drive_force_N)),
          numeric("simulate.friction", each(above(0)), "", "friction coefficient of each kind of ground",
                  FIELD(simulate.vehicle.friction)),
          numeric("simulate.shear", each(above(0)), "m",
                  "shear deformation modulus of each kind of ground, or one for all", FIELD(simulate.vehicle.shear_m)),
          numeric("simulate.resistance", each(at_least(0)), "",
                  "motion resistance over weight on each kind of ground, or one for all",
                  FIELD(simulate.vehicle.resistance)),
          numeric("simulate.patch", at_least(0), "m",
                  "side of the square tiles whose ground is drawn; 0: each run stays on one kind",
                  FIELD(simulate.vehicle.patch_m)),
          numeric("simulate.forward_speed", any(), "m/s", "added to both wheels of every command but standstill",
                  FIELD(simulate.vehicle.forward_speed_m_s)),
          numeric("simulate.turn_scale", at_least(0), "", "factor on the turning part of commands",
                  FIELD(simulate.vehicle.turn_scale)),
          numeric("simulate.gyro_noise_density", at_least(0), "rad/s/sqrt(Hz)",
                  "a sample's standard deviation is this times sqrt(state_rate_hz)",
                  FIELD(simulate.vehicle.sensors.gyro_noise_density)),
          numeric("simulate.gyro_bias", any(), "rad/s", "bias at the start of a run",
                  FIELD(simulate.vehicle.sensors.gyro_bias)),
          numeric("simulate.gyro_bias_walk", at_least(0), "rad/s/sqrt(s)", "random walk of the bias",
                  FIELD(simulate.vehicle.sensors.gyro_bias_walk)),
          numeric(
              "simulate.speed_noise_sd", at_least(0), "m/s",
              "noise of forward and sideways speed, which are measured when data.state names them after the yaw rate",
              FIELD(simulate.vehicle.sensors.speed_noise_sd)),
          numeric("simulate.wheel_quantum", at_least(0), "m/s", "wheel speeds are multiples of this; 0: exact",
                  FIELD(simulate.vehicle.sensors.wheel_quantum_m_s)),
          numeric(
              "simulate.lag_s", any(), "s",
              "the inputs file's times are this much early (negative: late): data.lag_s with the same value undoes it",
              FIELD(simulate.vehicle.sensors.lag_s)),
          numeric("simulate.drift", between(-0.5, 0.5), "s/s",
                  "true time = t + lag_s + drift * t for a time t of the inputs file",
                  FIELD(simulate.vehicle.sensors.drift)),
          numeric("simulate.step", at_least(0), "s", "integration step; 0: from the stiffest ground",
                  FIELD(simulate.vehicle.step_s)),
      });
}

#undef FIELD

}  // namespace

Config default_config() {
  Config config;
  for (Eigen::Index k = 1; k <= 12; ++k) config.mixture.selection.components.push_back(k);
  return config;
}

const std::vector<Option>& option_table() {
  static const std::vector<Option> table = [] {
    std::vector<Option> all;
    for (auto section : {data_options, window_options, mixture_options, bank_options, other_options, track_options,
                         simulate_options, simulate_linear_options, simulate_robot_options})
      for (Option& entry : section()) all.push_back(std::move(entry));
    return all;
  }();
  return table;
}

}  // namespace modebank::app
