#include "app/config/option_builders.hpp"
#include "app/config/options/sections.hpp"

namespace modebank::app {
namespace {

/// Random starts, or an archive that holds a mixture.
Option start_option() {
  Option result = text("mixture.start", "random | an archive",
                       "where EM begins: at points drawn as centres, or at the mixture of an archive for the candidate "
                       "of its size (the others as random)",
                       MODEBANK_FIELD(mixture_start));
  result.set = [](Config& config, const std::string& text) {
    if (text != "random" && !text.ends_with(".h5")) throw std::invalid_argument("must be random, or an archive (.h5)");
    config.mixture_start = text == "random" ? "" : text;
  };
  result.get = [](const Config& config) { return config.mixture_start.empty() ? "random" : config.mixture_start; };
  return result;
}

}  // namespace

std::vector<Option> mixture_options() {
  return {
      numeric("mixture.components", each(at_least(1)), "", "a number, a range such as 1..12, or a list",
              MODEBANK_FIELD(mixture.selection.components)),
      words("mixture.covariance", "shape of the components", MODEBANK_FIELD(mixture.selection.em.covariance)),
      words("mixture.criterion",
            "chooses the number of components, from 50,000 windows where there are more than 100,000",
            MODEBANK_FIELD(mixture.selection.criterion)),
      words("mixture.features",
            "what of a window is clustered: its coefficients, logarithms of its noise variances, too, or both of a fit "
            "of the same window with one lag; auto: parameters+noise up to 12 numbers, beyond one_lag where the model "
            "has lags, and of that the 12 that vary most beyond their errors",
            MODEBANK_FIELD(mixture.features)),
      words("mixture.windows",
            "which windows are clustered; automatic: full_rank, if there are enough (others are assigned afterwards); "
            "all with "
            "error_aware",
            MODEBANK_FIELD(mixture.windows)),
      words("mixture.straddling", "windows that straddle a switch of mode", MODEBANK_FIELD(mixture.straddling)),
      start_option(),
      numeric("mixture.restarts", between(1, 10'000), "", "independent starts per candidate",
              MODEBANK_FIELD(mixture.selection.em.restarts)),
      numeric("mixture.split_merge", between(0, 10'000), "",
              "moves tried to leave each optimum: two components merged, one split; 0: none, and restarts are not "
              "crossed",
              MODEBANK_FIELD(mixture.selection.em.split_merge)),
      numeric("mixture.tolerance", above(0), "nats/window", "stop when the mean log-likelihood gains less",
              MODEBANK_FIELD(mixture.selection.em.tolerance)),
      numeric("mixture.max_iterations", between(1, 1e6), "", "limit of each EM run",
              MODEBANK_FIELD(mixture.selection.em.max_iterations)),
      numeric("mixture.covariance_floor", between(0, 1), "window error variance",
              "smallest variance of a component; one that rests on it is chosen only if all do",
              MODEBANK_FIELD(mixture.selection.em.covariance_floor)),
      flag("mixture.error_aware",
           "the windows' own covariances enter the fit, so that components describe windows without their errors",
           MODEBANK_FIELD(mixture.error_aware)),
      flag("mixture.noise_component", "a uniform component for windows of no mode; they get the label -1",
           MODEBANK_FIELD(mixture.selection.em.noise_component)),
  };
}

}  // namespace modebank::app
