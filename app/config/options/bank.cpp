#include "app/config/option_builders.hpp"
#include "app/config/options/sections.hpp"

namespace modebank::app {

std::vector<Option> bank_options() {
  return {
      words("bank.theta", "a mode's parameters: pooled least squares, or the component's mean",
            MODEBANK_FIELD(bank.theta)),
      text("bank.mode_names", "names",
           "one per mode in the bank's order, for people; empty, or where there are fewer: by data.label, the label "
           "that holds 60 % of a mode's held-out samples",
           MODEBANK_FIELD(mode_names)),
      words("bank.noise", "process noise Q", MODEBANK_FIELD(bank.noise)),
      words("bank.noise_by_input",
            "whether one factor on all process noise, a fifth to five, follows states and inputs: auto: where training "
            "runs left out gain by it; it is not asked of adaptive noise, rounded or weighted samples, banks that em "
            "does not refine, modes that drift, a given R, bank.transition = logit or bank.look_ahead above 1",
            MODEBANK_FIELD(noise_by_input)),
      words("bank.transition",
            "transition matrix from window labels, or bank.stay; logit: as from labels, and in a refined bank a "
            "function of "
            "state and input where training runs left out gain by it",
            MODEBANK_FIELD(bank.transition)),
      numeric("bank.stay", above_to(0, 1), "",
              "probability to stay in a mode, for transition = stay; 1: modes never change", MODEBANK_FIELD(bank.stay)),
      numeric("bank.process_variance", above(0), "state unit^2", "Q for noise = fixed",
              MODEBANK_FIELD(bank.process_variance)),
      numeric("bank.measurement_variance", above(0), "state unit^2", "R; empty: the baseline's",
              MODEBANK_FIELD(bank.measurement_variance)),
      flag("bank.screen", "leave unstable and starved modes out of the bank", MODEBANK_FIELD(bank.screen)),
      numeric("bank.modes", between(0, 1000), "",
              "at most so many modes: the closest components are merged by moments; 0: no limit",
              MODEBANK_FIELD(bank.modes)),
      words("bank.refine",
            "em: expectation-maximisation of the switching model from the mixture's start; auto: that, but none for a "
            "motion model and where bank.theta, bank.noise or bank.transition = stay ask for what em would undo",
            MODEBANK_FIELD(bank.refine)),
      numeric("bank.restarts", between(0, 1000), "",
              "starts of em from random stretches of runs, besides the mixture's", MODEBANK_FIELD(bank.em.restarts)),
      numeric("bank.look_ahead", between(1, 1000), "samples",
              "what em chooses by: the mean log score of predictions 1 to so many samples ahead of the runs left out",
              MODEBANK_FIELD(bank.em.look_ahead)),
      words("bank.look_ahead_score",
            "what is counted of these predictions: their log density; error: their squared error, which the "
            "parameters of a bank of at most 50 free numbers then minimise where the runs left out gain by it, for "
            "forecasts and free runs; em chooses by one step",
            MODEBANK_FIELD(bank.em.look_ahead_score)),
      numeric(
          "bank.folds", between(1, 1000), "",
          "parts of the training runs that em leaves out in turn to choose start, number of modes and of iterations; "
          "1: none",
          MODEBANK_FIELD(bank.em.folds)),
      numeric("bank.refine_transitions", between(0, 1'000'000'000), "transitions",
              "em and the competitors learn from so many at most: where training runs have more, from stretches of "
              "them drawn with job.seed; all are scored; 0: from all",
              MODEBANK_FIELD(bank.em.transitions)),
      words("bank.drift",
            "whether each mode's theta goes on learning within a run: auto: as fast as training runs left out like it",
            MODEBANK_FIELD(bank.em.drift)),
      numeric("bank.max_iterations", between(1, 1000), "", "limit of em", MODEBANK_FIELD(bank.em.max_iterations)),
      numeric("bank.tolerance", above(0), "nats/transition", "em stops when the objective gains less",
              MODEBANK_FIELD(bank.em.tolerance)),
  };
}

std::vector<Option> filter_options() {
  return {
      words("filter.variant", "multiple-model filter", MODEBANK_FIELD(filter.variant)),
      words("filter.noise", "the modes' noise as learned, or times a scale that follows the run",
            MODEBANK_FIELD(filter.noise)),
      numeric("filter.horizon", each(between(1, 10'000)), "samples",
              "predictions this far ahead are scored, too: a number, a range such as 1..10, or a list; 1: the summary "
              "alone",
              MODEBANK_FIELD(scoring.horizon)),
      numeric("filter.simulate", between(0, 1'000'000'000), "samples",
              "free run: after so many measured samples of each run the rest is predicted from the inputs alone, and "
              "scored; 0: none",
              MODEBANK_FIELD(scoring.free_run.samples)),
      numeric("filter.simulate_horizon", between(0, 1'000'000'000), "samples",
              "of the free run: so many are predicted; 0: to the end of the run",
              MODEBANK_FIELD(scoring.free_run.horizon)),
      words("filter.simulate_start",
            "of the free run: what the filter knows after the measured samples; or the last of them as if it were the "
            "first",
            MODEBANK_FIELD(scoring.free_run.start)),
      words("filter.simulate_method",
            "of the free run: the modes' probabilities, means and covariances, exact for a constant transition matrix, "
            "each mode taken for a Gaussian; or sample paths, which bank.transition = logit always takes",
            MODEBANK_FIELD(scoring.free_run.method)),
      numeric("filter.paths", between(10, 1'000'000), "", "sample paths of a free run by paths",
              MODEBANK_FIELD(scoring.free_run.paths)),
      flag("filter.smooth", "smoothed states and the most probable sequence of modes, too",
           MODEBANK_FIELD(scoring.smooth)),
  };
}

}  // namespace modebank::app
