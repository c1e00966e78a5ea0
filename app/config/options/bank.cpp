#include <boost/algorithm/string.hpp>

#include "app/config/option_builders.hpp"
#include "app/config/options/sections.hpp"

namespace modebank::app {
namespace {

/// A number of samples, and whether errors are counted.
Option look_ahead_option() {
  Option result = of_several(
      "bank.look_ahead", "1 to 1000, and error or nothing", "samples",
      "what em chooses by: the mean log score of predictions 1 to so many samples ahead of the runs left out; "
      "error: their squared error, which the parameters of a bank of at most 50 free numbers then minimise where "
      "the runs left out gain by it, for forecasts and free runs; em chooses by one step");
  result.set = [](Config& config, const std::string& text) {
    const bool errors = text.ends_with(" error");
    Eigen::Index samples = 0;
    parse_value(boost::trim_copy(errors ? text.substr(0, text.size() - 6) : text), samples);
    if (samples < 1 || samples > 1000) throw std::invalid_argument("is out of range");
    config.bank.em.look_ahead = samples;
    config.bank.em.look_ahead_score = errors ? LookAheadScore::error : LookAheadScore::density;
  };
  result.get = [](const Config& config) {
    return format_value(config.bank.em.look_ahead) +
           (config.bank.em.look_ahead_score == LookAheadScore::error ? " error" : "");
  };
  return result;
}

}  // namespace

std::vector<Option> bank_options() {
  using enum Stage;
  return {
      words("bank.theta",
            "a mode's parameters: pooled least squares; or the component's mean, where unstable and starved modes stay "
            "in the bank",
            MODEBANK_FIELD(bank.theta))
          .touch("mean, for the published recipe", competitors),
      text("bank.mode_names", "names",
           "one per mode in the bank's order, for people; empty, or where there are fewer: by data.label, the label "
           "that holds 60 % of a mode's held-out samples",
           MODEBANK_FIELD(mode_names))
          .touch("when you know what the modes are and show the results to others", bank),
      words("bank.noise", "process noise Q", MODEBANK_FIELD(bank.noise))
          .touch("shared or fixed, to see what the modes' own noise is worth; such a bank is not refined", competitors),
      words("bank.noise_by_input",
            "whether one factor on all process noise, a fifth to five, follows states and inputs: auto: where training "
            "runs left out gain by it; it is not asked of adaptive noise, rounded or weighted samples, banks that em "
            "does not refine, modes that drift, a given R, bank.transition = logit or bank.look_ahead above 1",
            MODEBANK_FIELD(noise_by_input))
          .touch("none, for a bank that is exported to C or whose R is looked for", competitors),
      words("bank.transition",
            "transition matrix from window labels, or bank.stay; logit: as from labels, and in a refined bank a "
            "function of state and input where training runs left out gain by it",
            MODEBANK_FIELD(bank.transition))
          .touch("stay, when switches are too few to count; logit, when they depend on where one drives", competitors),
      numeric("bank.stay", above_to(0, 1), "",
              "probability to stay in a mode, for transition = stay; 1: modes never change", MODEBANK_FIELD(bank.stay))
          .touch("with transition = stay: 1 - 1/N for a mode that lasts N samples", bank),
      numeric("bank.process_variance", above(0), "state unit^2", "Q for noise = fixed",
              MODEBANK_FIELD(bank.process_variance))
          .touch("with noise = fixed: the Q you would have tuned by hand", bank),
      numeric("bank.measurement_variance", above(0), "state unit^2", "R; empty: the baseline's",
              MODEBANK_FIELD(bank.measurement_variance))
          .touch("when you know the sensor's noise and a warning says that R cannot be told", competitors),
      numeric("bank.modes", between(0, 1000), "",
              "at most so many modes: the closest components are merged by moments; 0: no limit",
              MODEBANK_FIELD(bank.modes))
          .touch("when the filter must be small, on a microcontroller: then the least that your score allows", bank,
                 basic),
      words("bank.refine",
            "em: expectation-maximisation of the switching model from the mixture's start; auto: that, but none for a "
            "motion model and where bank.theta, bank.noise or bank.transition = stay ask for what em would undo",
            MODEBANK_FIELD(bank.refine))
          .touch("none, for a look at the data in seconds, or to keep the mixture's own modes", competitors, basic),
      look_ahead_option().touch("when predictions several samples ahead matter (control): the number of samples; with "
                                "error, when the mean of long predictions matters (free run) and not their spread",
                                competitors),
      words("bank.drift",
            "whether each mode's theta goes on learning within a run: auto: as fast as training runs left out like it",
            MODEBANK_FIELD(bank.em.drift))
          .touch(
              "auto, when conditions change within a run (wear, load, temperature) and a competitor that drifts wins",
              competitors),
  };
}

std::vector<Option> filter_options() {
  using enum Stage;
  return {
      words("filter.variant", "multiple-model filter", MODEBANK_FIELD(filter.variant))
          .touch("never, unless you compare filters: imm serves; kf is the one model alone", competitors),
      words("filter.noise", "the modes' noise as learned, or times a scale that follows the run",
            MODEBANK_FIELD(filter.noise))
          .touch("adaptive, when the band is found false: the noise's scale then follows the run", competitors),
      numeric("filter.horizon", each(between(1, 10'000)), "samples",
              "predictions this far ahead are scored, too: a number, a range such as 1..10, or a list; 1: the summary "
              "alone",
              MODEBANK_FIELD(scoring.horizon))
          .touch("when you predict for control: the number of samples that the controller looks ahead", competitors,
                 basic),
      numeric("filter.simulate", between(0, 1'000'000'000), "samples",
              "free run: after so many measured samples of each run the rest is predicted from the inputs alone, and "
              "scored; 0: none",
              MODEBANK_FIELD(scoring.free_run.samples))
          .touch("when the model shall simulate: so many measured samples at the start, then inputs alone",
                 competitor_scores, basic),
      numeric("filter.simulate_horizon", between(0, 1'000'000'000), "samples",
              "of the free run: so many are predicted; 0: to the end of the run",
              MODEBANK_FIELD(scoring.free_run.horizon))
          .touch("when runs are so long that a free run to their end means nothing", competitor_scores),
      words("filter.simulate_start",
            "of the free run: what the filter knows after the measured samples; or the last of them as if it were the "
            "first",
            MODEBANK_FIELD(scoring.free_run.start))
          .touch("fixed, for comparison with benchmarks that start a free run from a measurement", competitor_scores),
      words("filter.simulate_method",
            "of the free run: the modes' probabilities, means and covariances, exact for a constant transition matrix, "
            "each mode taken for a Gaussian; or sample paths, which bank.transition = logit always takes",
            MODEBANK_FIELD(scoring.free_run.method))
          .touch("paths, when a mode's spread is no Gaussian and the band must show it; it takes longer",
                 competitor_scores),
      flag("filter.smooth", "smoothed states and the most probable sequence of modes, too",
           MODEBANK_FIELD(scoring.smooth))
          .touch("false, when archives of long runs are too large", competitor_scores),
  };
}

}  // namespace modebank::app
