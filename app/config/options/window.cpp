#include <fmt/ranges.h>

#include "app/config/option_builders.hpp"
#include "app/config/options/sections.hpp"
#include "ident/fit/fit_windows.hpp"
#include "ident/fit/window_length.hpp"
#include "ident/terms/stated_terms.hpp"

namespace modebank::app {
namespace {

/// auto, linear, varx and every motion model that is compiled in.
Option model_option() {
  std::vector<std::string> models = model_names();
  models.insert(models.begin() + 2, "auto");
  Option result =
      text("window.model", fmt::format("{}", fmt::join(models, " | ")),
           "A x + B u; with lags; with lags and a delay chosen by training runs left out; or a motion model of "
           "ident/model/models",
           MODEBANK_FIELD(window.model));
  result.set = [set = result.set, models](Config& config, const std::string& value) {
    if (std::find(models.begin(), models.end(), value) == models.end())
      throw std::invalid_argument("is none of its words");
    config.structure.automatic_model = value == "auto";
    set(config, value == "auto" ? "linear" : value);
  };
  result.get = [get = result.get](const Config& config) {
    return config.structure.automatic_model ? "auto" : get(config);
  };
  return result;
}

/// A number, or auto in its place, which with model = auto is the default. `meanwhile`: the number until it is found.
Option number_or_auto(Option number, const std::string& means, std::ptrdiff_t meanwhile, Field<std::ptrdiff_t> count,
                      Field<LagChoice> choice) {
  Option result = std::move(number);
  result.help += fmt::format("; auto: {}, as with model = auto", means);
  result.range += " or auto";
  result.set = [set = result.set, meanwhile, count, choice](Config& config, const std::string& text) {
    if (text != "auto") set(config, text);
    choice.in(config) = text == "auto" ? LagChoice::automatic : LagChoice::number;
    if (text == "auto") count.in(config) = meanwhile;
  };
  result.get = [get = result.get, choice](const Config& config) {
    return is_automatic(choice.of(config), config.structure.automatic_model) ? "auto" : get(config);
  };
  return result;
}

Option lag_option(std::string key, const Range& range, const std::string& help, Field<std::ptrdiff_t> count,
                  Field<LagChoice> choice) {
  return number_or_auto(numeric(std::move(key), range, "samples", help, count), "chosen by training runs left out", 1,
                        count, choice);
}

Option terms_option() {
  Option result =
      text("window.terms", "auto | none | TERM, TERM, ...",
           "whether one motion may bend, as the competitor nonlinear: auto: by terms that training runs left "
           "out ask for; or by these: NAME * NAME, |NAME|, max(0, NAME - NUMBER)",
           MODEBANK_FIELD(terms));
  result.set = [set = result.set](Config& config, const std::string& text) {
    if (lists_terms(text)) read_terms(text);
    set(config, text);
  };
  return result;
}

}  // namespace

std::vector<Option> window_options() {
  return {
      model_option(),
      lag_option("window.state_lags", between(1, 100), "varx: states x[k], x[k-1], ... that predict x[k+1]",
                 MODEBANK_FIELD(window.state_lags), MODEBANK_FIELD(structure.state)),
      lag_option("window.input_lags", between(1, 100), "varx: input samples that act on one transition",
                 MODEBANK_FIELD(window.input_lags), MODEBANK_FIELD(structure.input)),
      lag_option("window.input_delay", between(0, 1000),
                 "varx: from an input to its first effect; 0: u[k+1] acts on x[k+1]",
                 MODEBANK_FIELD(window.input_delay), MODEBANK_FIELD(structure.delay)),
      numeric("window.wheel_radius_m", above(0), "m",
              "icr and slip: turns wheel speeds in rad/s into m/s; 1 for inputs that are m/s",
              MODEBANK_FIELD(window.wheel_radius_m)),
      number_or_auto(
          numeric("window.length", between(1, 1e6), "transitions", "length of a window", MODEBANK_FIELD(window.length)),
          "25, or 1.5 to 3 times the model's regressors where that is more, the less the more often motion changes",
          shortest_automatic_length, MODEBANK_FIELD(window.length), MODEBANK_FIELD(structure.length)),
      number_or_auto(numeric("window.step", between(1, 1e6), "transitions", "from one window's start to the next",
                             MODEBANK_FIELD(window.step)),
                     "1, or as many as leave 100,000 windows", 1, MODEBANK_FIELD(window.step),
                     MODEBANK_FIELD(structure.step)),
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
      terms_option(),
      flag("window.intercept", "estimate a constant term c", MODEBANK_FIELD(window.intercept)),
      words("window.covariance", "covariance of a window's parameters: M-estimator or HC3 sandwich",
            MODEBANK_FIELD(window.covariance)),
      words(
          "window.solver",
          "who minimises: Ceres window by window, the batch solver for linear models of one state, or by their number",
          MODEBANK_FIELD(window.solver)),
      numeric("window.max_iterations", between(1, 1e5), "", "limit of the minimiser",
              MODEBANK_FIELD(window.max_iterations)),
  };
}

}  // namespace modebank::app
