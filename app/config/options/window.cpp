#include <fmt/ranges.h>

#include "app/config/option_builders.hpp"
#include "app/config/options/sections.hpp"
#include "ident/fit/fit_windows.hpp"
#include "ident/fit/window_length.hpp"
#include "ident/terms/stated_terms.hpp"

namespace modebank::app {
namespace {

/// window.model: auto, linear, varx or one of the compiled motion models.
Option model_option() {
  std::vector<std::string> models = model_names();
  models.insert(models.begin() + 2, "auto");
  Option result = text("window.model", fmt::format("{}", fmt::join(models, " | ")),
                       "model of a window. linear: A x + B u. varx: with lags. auto: with lags and a delay that "
                       "training runs left out choose. Others: motion models of ident/model/models",
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

/// An option whose value is a number or auto. With window.model = auto the default is auto. `meanwhile`: the number
/// until the search has found one.
template <class T>
Option number_or_auto(Option number, const std::string& means, std::ptrdiff_t meanwhile, Field<T> count,
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

template <class T>
Option lag_option(std::string key, const Range& range, const std::string& help, Field<T> count,
                  Field<LagChoice> choice) {
  return number_or_auto(numeric(std::move(key), range, "samples", help, count), "chosen by training runs left out", 1,
                        count, choice);
}

/// window.prior: a word, or the standard deviations of the global prior.
Option prior_option() {
  const Range range = each(above(0));
  Option result = of_several("window.prior", "none | global | each > 0", "parameter unit",
                             "Gaussian prior on a window's parameters. global: its mean is the fit of all training "
                             "runs, its standard deviation 3 times that of full-rank windows. Numbers: the same mean, "
                             "with these standard deviations, one per parameter or one for all");
  result.set = [range](Config& config, const std::string& text) {
    std::vector<double> widths;
    Prior kind = Prior::global;
    if (text == "none" || text == "global")
      parse_value(text, kind);
    else
      parse_value(text, widths);
    if (!in_range(range, widths)) throw std::invalid_argument("is out of range");
    config.window.prior = kind;
    config.window.prior_sd = std::move(widths);
  };
  result.get = [](const Config& config) {
    const FitOptions& window = config.window;
    return window.prior == Prior::global && std::ssize(window.prior_sd) > 0 ? format_value(window.prior_sd)
                                                                            : format_value(window.prior);
  };
  return result;
}

Option intercept_option() {
  Option result = flag("window.intercept",
                       "whether the model has a constant term c. auto: unless leaving it out loses less than 6 nats on "
                       "the training runs",
                       MODEBANK_FIELD(window.intercept));
  result.range += " | auto";
  result.also = {"offset", "bias", "operating point"};
  result.set = [set = result.set](Config& config, const std::string& text) {
    config.structure.automatic_intercept = text == "auto";
    set(config, text == "auto" ? "false" : text);
  };
  result.get = [get = result.get](const Config& config) {
    return config.structure.automatic_intercept ? "auto" : get(config);
  };
  return result;
}

Option terms_option() {
  Option result = text("window.terms", "auto | none | TERM, TERM, ...",
                       "nonlinear terms of the competitor nonlinear. auto: those by which training runs left out gain; "
                       "or a list of NAME * NAME, |NAME|, max(0, NAME - NUMBER)",
                       MODEBANK_FIELD(terms));
  result.set = [set = result.set](Config& config, const std::string& text) {
    if (lists_terms(text)) read_terms(text);
    set(config, text);
  };
  return result;
}

}  // namespace

std::vector<Option> window_options() {
  using enum Stage;
  return {
      model_option().touch("auto, when the screen reports a pattern in the errors, or the plant answers late; a motion "
                           "model, when you need its parameters (a track, a radius)",
                           structure, basic),
      lag_option("window.state_lags", between(1, 100),
                 "number of past states x[k], x[k-1], ... that predict x[k+1], with varx",
                 MODEBANK_FIELD(window.state_lags), MODEBANK_FIELD(structure.state))
          .touch("with varx, or to keep auto from searching: when the order of the motion is known", structure),
      lag_option("window.input_lags", between(1, 100), "number of input samples that act on one transition, with varx",
                 MODEBANK_FIELD(window.input_lags), MODEBANK_FIELD(structure.input))
          .touch("with varx, or to keep auto from searching: when the length of the input's effect is known",
                 structure),
      lag_option("window.input_delay", each(between(0, 1000)),
                 "time from an input to its first effect, with varx: one number for all inputs, or one per input; 0: "
                 "u[k+1] acts on x[k+1]",
                 MODEBANK_FIELD(window.input_delay), MODEBANK_FIELD(structure.delay))
          .touch("with varx, or to keep auto from searching: when a dead time of whole samples is known. Lags between "
                 "clocks are data.lag_s",
                 structure),
      number_or_auto(
          numeric("window.length", between(1, 1e6), "transitions", "length of a window", MODEBANK_FIELD(window.length)),
          "25, or 1.5 to 3 times the number of regressors if that is more; few where the motion changes often",
          shortest_automatic_length, MODEBANK_FIELD(window.length), MODEBANK_FIELD(structure.length))
          .touch("longer, for rank-deficient windows, which `modebank check` counts; shorter, for modes that last less "
                 "than "
                 "a window; auto, when the model has many lags",
                 windows, basic),
      number_or_auto(numeric("window.step", between(1, 1e6), "transitions",
                             "distance from one window's start to the next", MODEBANK_FIELD(window.step)),
                     "1, or the distance that leaves 100,000 windows", 1, MODEBANK_FIELD(window.step),
                     MODEBANK_FIELD(structure.step))
          .touch("larger, when the windows take too long: neighbours share most of their samples", windows),
      words("window.loss", "robust loss of a sample's residual", MODEBANK_FIELD(window.loss))
          .touch("tukey, for gross errors; trivial, for clean data", windows),
      prior_option().touch("none, when every window has full rank, and for the published recipe; standard deviations, "
                           "when the prior pulls windows of a rare ground towards the common one",
                           windows),
      terms_option().touch("a list, when physics gives the terms, such as vx * wz; none, to leave the competitor "
                           "nonlinear and its time out",
                           competitors),
      intercept_option().touch("true, when the motion has a constant part: a slope, a leak, a sensor's offset or "
                               "operating point, a bias; false, for the published recipe",
                               windows),
      words("window.covariance", "covariance of a window's parameters: of the M-estimator (model), or HC3 sandwich",
            MODEBANK_FIELD(window.covariance))
          .touch("sandwich, when noise varies within a window and you use the windows' standard errors", windows),
  };
}

}  // namespace modebank::app
