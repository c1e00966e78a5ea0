#include "app/config/option_builders.hpp"
#include "app/config/options/sections.hpp"

namespace modebank::app {
std::vector<Option> mixture_options() {
  using enum Stage;
  return {
      numeric("mixture.components", each(at_least(1)), "", "a number, a range such as 1..12, or a list",
              MODEBANK_FIELD(mixture.selection.components))
          .touch("when the selected number stands at the end of the range; a single number to repeat a study", mixture,
                 basic),
      words("mixture.covariance", "shape of the components", MODEBANK_FIELD(mixture.selection.em.covariance))
          .touch("diagonal, when windows are few for their parameters", mixture),
      words("mixture.criterion",
            "chooses the number of components, from 50,000 windows where there are more than 100,000",
            MODEBANK_FIELD(mixture.selection.criterion))
          .touch("rarely: a refined bank chooses its number of modes by runs left out; the others are for studies of "
                 "the mixture",
                 mixture),
      words("mixture.features",
            "what of a window is clustered: its coefficients, logarithms of its noise variances, too, or both of a fit "
            "of the same window with one lag; auto: parameters+noise up to 12 numbers, beyond one_lag where the model "
            "has lags, and of that the 12 that vary most beyond their errors",
            MODEBANK_FIELD(mixture.features))
          .touch("parameters, when modes should differ in motion and not in noise alone; parameters+noise with "
                 "bank.theta = mean",
                 mixture),
      words("mixture.windows",
            "which windows are clustered; automatic: full_rank, if there are enough (others are assigned afterwards); "
            "all with "
            "error_aware",
            MODEBANK_FIELD(mixture.windows))
          .touch("all, with error_aware, when hardly any window is of full rank", mixture),
      words("mixture.straddling", "windows over a switch of mode", MODEBANK_FIELD(mixture.straddling))
          .touch("never, unless you study how windows over a switch blur the components", mixture),
      numeric("mixture.restarts", between(1, 10'000), "",
              "independent starts per candidate; three for every ten, from random stretches of runs, are starts of "
              "bank.refine = em",
              MODEBANK_FIELD(mixture.selection.em.restarts))
          .touch("more, when a warning says that few restarts reached the best optimum, or repeated runs with other "
                 "seeds differ by more than the gain's standard error",
                 mixture),
      numeric("mixture.split_merge", between(0, 10'000), "",
              "moves tried to leave each optimum: two components merged, one split; 0: none, and restarts are not "
              "crossed",
              MODEBANK_FIELD(mixture.selection.em.split_merge))
          .touch("0, to see what plain restarts find; else never", mixture),
      flag("mixture.error_aware",
           "the windows' own covariances enter the fit, so that components describe windows without their errors",
           MODEBANK_FIELD(mixture.error_aware))
          .touch("when windows are noisy and differ much in how well they are excited", mixture),
      flag("mixture.noise_component", "a uniform component for windows of no mode; they get the label -1",
           MODEBANK_FIELD(mixture.selection.em.noise_component))
          .touch("when some windows are of no mode (collisions, lifts) and blur the others", mixture),
  };
}

}  // namespace modebank::app
