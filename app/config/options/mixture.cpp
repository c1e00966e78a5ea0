#include "app/config/option_builders.hpp"
#include "app/config/options/sections.hpp"

namespace modebank::app {
std::vector<Option> mixture_options() {
  using enum Stage;
  return {
      numeric("mixture.components", each(at_least(1)), "",
              "numbers of components to try: a number, a range such as 1..12, or a list. BIC chooses; of more than "
              "100,000 windows it uses 50,000",
              MODEBANK_FIELD(mixture.selection.components))
          .touch(
              "when the chosen number lies at the end of the range: a wider range; a single number, to repeat a study",
              mixture, basic),
      words("mixture.covariance", "covariance of each component: full or diagonal matrices",
            MODEBANK_FIELD(mixture.selection.em.covariance))
          .touch("diagonal, when there are few windows for the number of parameters", mixture),
      words("mixture.features",
            "features of a window that are clustered. parameters: its coefficients. parameters+noise: also the "
            "logarithms of its noise variances. one_lag: both, from a fit of the window with one lag. auto: "
            "parameters+noise up to 12 numbers; beyond, the 12 of one_lag that vary most beyond their errors",
            MODEBANK_FIELD(mixture.features))
          .touch("parameters, when modes that differ only in noise should be one mode; parameters+noise with "
                 "bank.theta = mean",
                 mixture),
      words("mixture.windows",
            "windows that are clustered; the others are assigned afterwards. automatic: full_rank, or all where these "
            "are too few or with mixture.error_aware",
            MODEBANK_FIELD(mixture.windows))
          .touch("all, with mixture.error_aware, when few windows have full rank", mixture),
      words("mixture.straddling", "whether windows over a switch of mode are left out or kept",
            MODEBANK_FIELD(mixture.over_switch))
          .touch("rarely: to study how windows over a switch blur the components", mixture),
      numeric("mixture.restarts", between(1, 10'000), "",
              "random starts per number of components. bank.refine = em has three more for every ten of them, from "
              "random parts of runs",
              MODEBANK_FIELD(mixture.selection.em.restarts))
          .touch("more, when a warning says that few restarts reached the best optimum, or when other values of "
                 "job.seed change the gain by more than its standard error",
                 mixture),
      numeric("mixture.split_merge", between(0, 10'000), "",
              "moves tried from each optimum: merge two components and split a third. 0: none, and solutions of "
              "different restarts are not combined",
              MODEBANK_FIELD(mixture.selection.em.split_merge))
          .touch("rarely: 0, to see what plain restarts find", mixture),
      flag("mixture.error_aware",
           "whether the fit uses each window's own parameter covariance, so that components are free of estimation "
           "errors",
           MODEBANK_FIELD(mixture.error_aware))
          .touch("when windows are noisy and their excitation differs much", mixture),
      flag("mixture.noise_component", "whether windows that belong to no mode get a uniform component and the label -1",
           MODEBANK_FIELD(mixture.selection.em.noise_component))
          .touch("when some windows belong to no mode (collisions, lifts) and blur the others", mixture),
  };
}

}  // namespace modebank::app
