#include <boost/algorithm/string.hpp>

#include "app/config/option_builders.hpp"
#include "app/config/options/sections.hpp"

namespace modebank::app {
std::vector<Option> bank_options() {
  using enum Stage;
  return {
      words("bank.theta",
            "source of a mode's parameters: least squares over the windows of its component, or the component's mean; "
            "with mean, modes that are unstable or have few windows stay in the bank",
            MODEBANK_FIELD(bank.theta))
          .touch("mean, for the published recipe", bank),
      text("bank.mode_names", "names",
           "names of the modes in the bank's order, separated by commas. A mode without a name takes the label "
           "(data.label) of at least 60 % of its held-out samples",
           MODEBANK_FIELD(mode_names))
          .touch("when you know what the modes are and show the results to others", bank),
      words("bank.transition",
            "source of the mode transition matrix: counted from the windows' labels, or made from bank.stay. logit: in "
            "a refined bank the probabilities are a function of state and input where training runs left out gain",
            MODEBANK_FIELD(bank.transition))
          .touch("stay, when the log has few switches; logit, when switches depend on state or input", bank),
      numeric("bank.stay", above_to(0, 1), "",
              "probability that a mode continues at the next sample, for bank.transition = stay; 1: modes never change",
              MODEBANK_FIELD(bank.stay))
          .touch("with bank.transition = stay: 0.98 for modes that last 50 samples (1 - 1/N for N samples)", bank),
      numeric("bank.process_variance", above(0), "state unit^2",
              "process noise variance Q of every state; empty: each mode learns its own",
              MODEBANK_FIELD(bank.process_variance))
          .touch("the Q that you would tune by hand, to compare; such a bank is not refined", bank),
      numeric("bank.measurement_variance", above(0), "state unit^2",
              "measurement noise variance R; empty: the one that the baseline learns",
              MODEBANK_FIELD(bank.measurement_variance))
          .touch("when a warning says that R cannot be estimated: the square of your sensor's noise", competitors),
      words("bank.refine",
            "learning after the mixture. em: expectation-maximisation of the switching model. none: the mixture's "
            "modes stay. auto: em, but none for a motion model, bank.theta = mean, bank.transition = stay and a "
            "given bank.process_variance",
            MODEBANK_FIELD(bank.refine))
          .touch("none, for a first look at the data in seconds, or to keep the mixture's own modes", bank, basic),
  };
}

std::vector<Option> filter_options() {
  using enum Stage;
  return {
      words("filter.variant",
            "filter that is judged: imm (interacting multiple model), salvi2025 (of the published recipe) or kf (one "
            "Kalman filter)",
            MODEBANK_FIELD(filter.variant))
          .touch("rarely: to compare filters", competitors),
      numeric("filter.horizon", each(between(1, 10'000)), "samples",
              "how far ahead predictions are scored: a number, a range such as 1..10, or a list; 1: the screen's "
              "summary only",
              MODEBANK_FIELD(scoring.horizon))
          .touch("for control: the number of samples that the controller predicts ahead", bank, basic),
      numeric("filter.simulate", between(0, 1'000'000'000), "samples",
              "measured samples at the start of a free run; the rest of each run is predicted from its inputs alone, "
              "and scored. 0: no free run",
              MODEBANK_FIELD(scoring.free_run.samples))
          .touch("when you will use the model as a simulator: 50, or as many samples as its start needs",
                 competitor_scores, basic),
  };
}

}  // namespace modebank::app
