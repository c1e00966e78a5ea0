#include "app/option_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <stdexcept>

#include "app/option_builders.hpp"
#include "app/report/report_options.hpp"
#include "app/simulate_options.hpp"
#include "app/study/study_options.hpp"
#include "ident/motion_model.hpp"

namespace modebank::app {
namespace {

/// A number, or a word in its place.
Option lag_option() {
  Option result = numeric("data.lag_s", any(), "s",
                          "inputs act this much later (negative: earlier); auto estimates lag and clock drift per run "
                          "on the training runs and applies them if cross-validation among these gains",
                          MODEBANK_FIELD(data.lag_s));
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
           MODEBANK_FIELD(data.root)),
      text("data.inputs", "a path with at most one *", "one file per run; the part matched by * names the run",
           MODEBANK_FIELD(data.inputs)),
      text("data.states", "a path with at most one *",
           "the runs' states files; empty: states are columns of the inputs files", MODEBANK_FIELD(data.states)),
      text("data.state", "column names", "measured states", MODEBANK_FIELD(data.state)),
      text("data.input", "column names", "inputs", MODEBANK_FIELD(data.input)),
      text("data.truth", "column names", "true states, one per state, where known; empty: none",
           MODEBANK_FIELD(data.truth)),
      text("data.weight", "a column name",
           "sample weights >= 0 of the transitions that end in each sample, 0 leaves one out; empty: all equal",
           MODEBANK_FIELD(data.weight)),
      text("data.state_unit", "units", "one per state, or one for all; written to the archive and the plots",
           MODEBANK_FIELD(data.state_unit)),
      text("data.input_unit", "units", "one per input, or one for all", MODEBANK_FIELD(data.input_unit)),
      text("data.time", "a column name", "time in seconds", MODEBANK_FIELD(data.time)),
      words("data.join", "how states join the inputs: interpolated at the inputs' times, or row by row",
            MODEBANK_FIELD(data.join)),
      text("data.run", "a column name", "column whose value separates runs inside one file; empty: one run per file",
           MODEBANK_FIELD(data.run)),
      numeric("data.rate_hz", at_least(0), "Hz", "0: the inputs' own times; else resample (states linear, inputs held)",
              MODEBANK_FIELD(data.rate_hz)),
      lag_option(),
      numeric("data.lag_range_s", above(0), "s",
              "lags from minus to plus this are searched by lag_s = auto and by check",
              MODEBANK_FIELD(data.lag_range_s)),
      words("data.missing",
            "NaN, infinite or empty values: an error; a gap that splits the run; or a missing state is a step of "
            "prediction only, a missing input the last known one",
            MODEBANK_FIELD(data.missing)),
      words("data.disorder",
            "time going backwards or repeated: an error, or sort the rows and keep the first of each time",
            MODEBANK_FIELD(data.disorder)),
      text("data.train", "run names", "training runs; empty: positions 0, 2, 4, ... in name order",
           MODEBANK_FIELD(data.train)),
      text("data.test", "run names", "held-out runs; empty: all that do not train", MODEBANK_FIELD(data.test)),
  };
}

/// linear, varx and every motion model that is compiled in.
Option model_option() {
  std::vector<std::string> models{"linear", "varx"};
  for (const std::string& model : motion_model_names()) models.push_back(model);
  Option result = text("window.model", fmt::format("{}", fmt::join(models, " | ")),
                       "A x + B u; with lags; or a motion model of ident/models", MODEBANK_FIELD(window.model));
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
              MODEBANK_FIELD(window.state_lags)),
      numeric("window.input_lags", between(1, 100), "samples", "varx: input samples that act on one transition",
              MODEBANK_FIELD(window.input_lags)),
      numeric("window.input_delay", between(0, 1000), "samples",
              "varx: from an input to its first effect; 0: u[k+1] acts on x[k+1]", MODEBANK_FIELD(window.input_delay)),
      numeric("window.wheel_radius_m", above(0), "m",
              "icr and slip: turns wheel speeds in rad/s into m/s; 1 for inputs that are m/s",
              MODEBANK_FIELD(window.wheel_radius_m)),
      words("window.residual",
            "each sample predicted from the one before, or the window simulated from its first sample (estimated)",
            MODEBANK_FIELD(window.residual)),
      numeric("window.length", between(1, 1e6), "transitions", "length of a window", MODEBANK_FIELD(window.length)),
      numeric("window.step", between(1, 1e6), "transitions", "from one window's start to the next",
              MODEBANK_FIELD(window.step)),
      words("window.loss", "robust loss of a sample's residual", MODEBANK_FIELD(window.loss)),
      numeric("window.loss_scale", at_least(0), "sigma", "where the loss bends; 0: 95 % efficiency under normal noise",
              MODEBANK_FIELD(window.loss_scale)),
      words("window.scale", "residual scale sigma: of each window, of its run, or window.sigma",
            MODEBANK_FIELD(window.scale)),
      numeric("window.sigma", at_least(0), "state unit", "residual standard deviation for scale = fixed",
              MODEBANK_FIELD(window.sigma)),
      words("window.prior", "Gaussian prior on a window's parameters", MODEBANK_FIELD(window.prior)),
      numeric("window.prior_sd", each(above(0)), "parameter unit",
              "the prior's standard deviations, one per parameter or one for all; empty: 3 x the spread of full-rank "
              "windows",
              MODEBANK_FIELD(window.prior_sd)),
      flag("window.intercept", "estimate a constant term c", MODEBANK_FIELD(window.intercept)),
      words("window.covariance", "covariance of a window's parameters: M-estimator or HC3 sandwich",
            MODEBANK_FIELD(window.covariance)),
      words("window.solver",
            "who minimises: Ceres window by window, the batch solver for linear models of one state, or whichever can",
            MODEBANK_FIELD(window.solver)),
      numeric("window.max_iterations", between(1, 1e5), "", "limit of the minimiser",
              MODEBANK_FIELD(window.max_iterations)),
  };
}

/// A way to start, or an archive that holds a mixture.
Option start_option() {
  Option result =
      words("mixture.start",
            "where EM begins: auto (the first restart hierarchical, then random and k-means++ in turn), one "
            "way for all, or the mixture of an archive for the candidate of its size (the others as auto)",
            MODEBANK_FIELD(mixture.selection.em.start));
  result.range += " | an archive";
  result.set = [](Config& config, const std::string& text) {
    const std::optional<StartKind> kind = parse_name<StartKind>(text);
    if (!kind && !text.ends_with(".h5"))
      throw std::invalid_argument("must be one of " + words_of<StartKind>() + ", or an archive (.h5)");
    config.mixture.selection.em.start = kind.value_or(StartKind::automatic);
    config.mixture.start_file = kind ? "" : text;
  };
  result.get = [get = result.get](const Config& config) {
    return config.mixture.start_file.empty() ? get(config) : config.mixture.start_file;
  };
  return result;
}

std::vector<Option> mixture_options() {
  return {
      numeric("mixture.components", each(at_least(1)), "", "a number, a range such as 1..12, or a list",
              MODEBANK_FIELD(mixture.selection.components)),
      words("mixture.covariance", "shape of the components", MODEBANK_FIELD(mixture.selection.em.covariance)),
      words("mixture.criterion", "chooses the number of components", MODEBANK_FIELD(mixture.selection.criterion)),
      words("mixture.features", "what is clustered", MODEBANK_FIELD(mixture.features)),
      words("mixture.windows", "which windows are clustered; automatic: all with a prior, else full_rank",
            MODEBANK_FIELD(mixture.windows)),
      words("mixture.straddling", "windows that straddle a switch of mode",
            MODEBANK_FIELD(mixture.selection.straddling)),
      start_option(),
      numeric("mixture.restarts", between(1, 10'000), "", "independent starts per candidate",
              MODEBANK_FIELD(mixture.selection.em.restarts)),
      numeric("mixture.start_runs", between(1, 10'000), "",
              "short runs that a k-means++ or random start is the best of; 1: single starts",
              MODEBANK_FIELD(mixture.selection.em.start_runs)),
      numeric("mixture.split_merge", between(0, 10'000), "",
              "moves tried to leave each optimum: two components merged, one split; 0: none, and restarts are not "
              "crossed",
              MODEBANK_FIELD(mixture.selection.em.split_merge)),
      words("mixture.heldout",
            "score candidates by leaving out runs; auto: up to 20,000 windows; never: only as the criterion",
            MODEBANK_FIELD(mixture.selection.heldout)),
      numeric("mixture.bootstrap", between(0, 100'000), "",
              "resamples of the runs for standard errors of weights and means; 0: none",
              MODEBANK_FIELD(mixture.selection.bootstrap)),
      numeric("mixture.tolerance", above(0), "nats/window", "stop when the mean log-likelihood gains less",
              MODEBANK_FIELD(mixture.selection.em.tolerance)),
      numeric("mixture.max_iterations", between(1, 1e6), "", "limit of each EM run",
              MODEBANK_FIELD(mixture.selection.em.max_iterations)),
      numeric("mixture.covariance_floor", between(0, 1), "feature variance", "smallest variance of a component",
              MODEBANK_FIELD(mixture.selection.em.covariance_floor)),
      flag("mixture.error_aware",
           "the windows' own covariances enter the fit, so that components describe windows without their errors",
           MODEBANK_FIELD(mixture.error_aware)),
      flag("mixture.noise_component", "a uniform component for windows of no mode; they get the label -1",
           MODEBANK_FIELD(mixture.selection.em.noise_component)),
  };
}

std::vector<Option> bank_options() {
  return {
      words("bank.theta", "a mode's parameters: pooled least squares, or the component's mean",
            MODEBANK_FIELD(bank.theta)),
      words("bank.noise", "process noise Q", MODEBANK_FIELD(bank.noise)),
      words("bank.transition", "transition matrix from window labels, or bank.stay", MODEBANK_FIELD(bank.transition)),
      numeric("bank.stay", inside(0, 1), "", "probability to stay in a mode, for transition = stay",
              MODEBANK_FIELD(bank.stay)),
      numeric("bank.process_variance", above(0), "state unit^2", "Q for noise = fixed",
              MODEBANK_FIELD(bank.process_variance)),
      numeric("bank.measurement_variance", above(0), "state unit^2", "R; empty: the baseline's",
              MODEBANK_FIELD(bank.measurement_variance)),
      flag("bank.screen", "leave unstable and starved modes out of the bank", MODEBANK_FIELD(bank.screen)),
      numeric("bank.modes", between(0, 1000), "",
              "at most so many modes: the closest components are merged by moments; 0: no limit",
              MODEBANK_FIELD(bank.modes)),
      words("bank.refine", "em: expectation-maximisation of the switching model from the mixture's start",
            MODEBANK_FIELD(bank.refine)),
      words("bank.share",
            "what refined modes have in common; best: what the runs left out in cross-validation like most",
            MODEBANK_FIELD(bank.em.share)),
      numeric("bank.restarts", between(0, 1000), "",
              "starts of em from random stretches of runs, besides the mixture's", MODEBANK_FIELD(bank.em.restarts)),
      numeric("bank.members", between(1, 100), "",
              "refined fits from different starts that become one bank at most, if the runs left out like it; their "
              "modes add up",
              MODEBANK_FIELD(bank.em.members)),
      numeric(
          "bank.folds", between(1, 1000), "",
          "parts of the training runs that em leaves out in turn to choose start, number of modes and of iterations; "
          "1: none",
          MODEBANK_FIELD(bank.em.folds)),
      numeric("bank.max_iterations", between(1, 1000), "", "limit of em", MODEBANK_FIELD(bank.em.max_iterations)),
      numeric("bank.tolerance", above(0), "nats/transition", "em stops when the objective gains less",
              MODEBANK_FIELD(bank.em.tolerance)),
  };
}

std::vector<Option> other_options() {
  return {
      words("filter.variant", "multiple-model filter", MODEBANK_FIELD(filter.variant)),
      words("filter.noise", "the modes' noise as learned, or times a scale that follows the run",
            MODEBANK_FIELD(filter.noise)),
      flag("filter.parameter_noise", "add the modes' parameter spread to Q", MODEBANK_FIELD(filter.parameter_noise)),
      words("filter.time_steps",
            "a longer time between samples: as many prediction steps as fit, the input held; or one step always",
            MODEBANK_FIELD(filter.time_steps)),
      numeric("filter.horizon", each(between(1, 10'000)), "samples",
              "predictions this far ahead are scored, too: a number, a range such as 1..10, or a list; 1: the summary "
              "alone",
              MODEBANK_FIELD(scoring.horizon)),
      flag("filter.smooth", "smoothed states and the most probable sequence of modes, too",
           MODEBANK_FIELD(scoring.smooth)),
      text("archive.output", "a path", "archive to write; empty: this file's name with .h5, in the current folder",
           MODEBANK_FIELD(archive.output)),
      text("archive.input", "an archive", "supplies the earlier stages of identify, cluster and evaluate",
           MODEBANK_FIELD(archive.input)),
      text("archive.bank", "an archive", "evaluate: its banks are run instead of learning new ones",
           MODEBANK_FIELD(archive.bank)),
      numeric("job.threads", between(0, 1024), "", "0: all cores; never changes a number", MODEBANK_FIELD(job.threads)),
      option("job.seed", "a whole number >= 0", "", "the one seed; every use of randomness derives from it",
             MODEBANK_FIELD(job.seed)),
  };
}

std::vector<Option> track_options() {
  return {
      words("track.filter", "which of the archive's filters runs", MODEBANK_FIELD(track.filter)),
      words("track.format", "of lines in and out: CSV under a header, or a JSON object each; auto: by the first line",
            MODEBANK_FIELD(track.format)),
      numeric("track.level", inside(0, 1), "", "probability of the interval about the prediction",
              MODEBANK_FIELD(track.level)),
      numeric("track.alarm", inside(0, 1), "",
              "alarm when a measurement lies further out than this share of a true filter's would",
              MODEBANK_FIELD(track.alarm)),
      text("track.checkpoint", "a path", "where the filter's state is kept at the end of the input or on SIGINT",
           MODEBANK_FIELD(track.checkpoint)),
      numeric("track.checkpoint_interval", at_least(0), "samples", "and this often; 0: at the end only",
              MODEBANK_FIELD(track.checkpoint_interval)),
      text("track.resume", "a checkpoint", "go on from there", MODEBANK_FIELD(track.resume)),
  };
}

}  // namespace

Config default_config() {
  Config config;
  for (Eigen::Index k = 1; k <= 12; ++k) config.mixture.selection.components.push_back(k);
  return config;
}

const std::vector<Option>& option_table() {
  static const std::vector<Option> table = [] {
    std::vector<Option> all;
    for (auto section : {data_options, window_options, mixture_options, bank_options, other_options, study_options,
                         track_options, report_options, simulate_options})
      for (Option& entry : section()) all.push_back(std::move(entry));
    return all;
  }();
  return table;
}

const Option* find_option(const std::string& key) {
  const std::vector<Option>& table = option_table();
  const auto found = std::find_if(table.begin(), table.end(), [&](const Option& option) { return option.key == key; });
  return found == table.end() ? nullptr : &*found;
}

}  // namespace modebank::app
