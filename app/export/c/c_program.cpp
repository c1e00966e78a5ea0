#include <fmt/format.h>

#include <boost/algorithm/string.hpp>
#include <iterator>

#include "app/export/c/c_parts.hpp"
#include "app/export/c/c_texts.hpp"
#include "filter/step/equations/bounds.hpp"
#include "filter/step/equations/noise_scale.hpp"
#include "filter/step/feed/sample_feed.hpp"

namespace modebank::app::c_form {
namespace {

/// What keeps the arithmetic sound; single precision has its own range.
struct Bounds {
  double largest_variance, largest_mean, least_variance, impossible, lowest_log_density, largest_measurement, pivot,
      overflow;
};
constexpr Bounds of_double{largest_variance,   largest_mean,        least_variance,       impossible_probability,
                           lowest_log_density, largest_measurement, relative_pivot_floor, 1e300};
constexpr Bounds of_float{1e18, 1e9, 1e-30, 1e-30, -1e30, 1e15, 1e-7, 1e30};

/// Means and probabilities before mixing: of the modes themselves, or what the transition matrix makes of them.
std::string mixing(const ExportedBank& exported) {
  if (exported.bank.mode_count() == 1) return no_mixing;
  const bool logit = !exported.bank.transition_logit.empty();
  std::string text = (logit ? std::string(transition_at) : "") + mixing_weights + mix_imm;
  boost::algorithm::replace_all(text, "@TRANSITION@", logit ? with_logit : "");
  boost::algorithm::replace_all(text, "@T@", logit ? "T" : "bank_T");
  return text;
}

}  // namespace

std::string constants(const ExportedBank& exported, bool single_precision) {
  const Bounds bounds = single_precision ? of_float : of_double;
  const LinearStructure& s = exported.structure();
  const NoiseAdaptation& adaptation = exported.bank.noise_adaptation;
  std::string text;
  const auto to = std::back_inserter(text);
  fmt::format_to(to, "#define DT_S {:.17g} /* a step takes [s] */\n", exported.bank.dt_s);
  fmt::format_to(to, "#define STATE_LAGS {}\n#define INPUT_DELAY {}\n#define FIRST_STEP {}\n", s.state_lags,
                 s.input_delay, s.first_transition());
  fmt::format_to(to, "#define ACTING_ROOM {}\n", std::max<Index>(1, s.acting_inputs()));
  fmt::format_to(to, "#define LONGEST_GAP {} /* steps without a sample, then the filter starts anew */\n\n",
                 longest_gap_steps);
  const auto bound = [&](const char* name, double value, const char* what) {
    const std::string digits = fmt::format("{}", value);
    fmt::format_to(to, "#define {} {}{} /* {} */\n", name, digits,
                   digits.find_first_of(".e") == std::string::npos ? ".0$F" : "$F", what);
  };
  bound("LARGEST_VARIANCE", bounds.largest_variance, "a diverging prediction stops growing here");
  bound("LARGEST_MEAN", bounds.largest_mean, "and here");
  bound("LEAST_VARIANCE", bounds.least_variance, "of a measurement");
  bound("IMPOSSIBLE", bounds.impossible, "a mode of lower probability takes no part");
  bound("LEAST_PROBABILITY", mode_probability_floor, "no mode dies for good");
  bound("LOWEST_LOG_DENSITY", bounds.lowest_log_density, "lower ones are not told apart [nats]");
  bound("LARGEST_MEASUREMENT", bounds.largest_measurement, "what is not smaller is missing");
  bound("LEAST_PIVOT", bounds.pivot, "share of a diagonal entry that is rounding");
  bound("LARGEST_SQUARE", bounds.overflow, "an innovation beyond says nothing about the noise");
  if (!exported.bank.transition_logit.empty())
    bound("LEAST_LOG_ODDS", single_precision ? -60.0 : -largest_log_odds, "further odds are as good as certain");
  if (exported.options.noise == FilterNoise::adaptive) {
    bound("FORGETTING", adaptation.forgetting, "of the noise scale, per sample");
    bound("PRIOR_SAMPLES", adaptation.prior_samples, "that a start is worth at scale one");
    bound("LARGEST_STANDARDISED", largest_standardised, "standard deviations that an outlier counts as, at most");
    bound("LARGEST_NOISE_SCALE", largest_noise_scale, "and its inverse the least");
  }
  return text + "\n";
}

std::string program(const ExportedBank& exported) {
  const bool adaptive = exported.options.noise == FilterNoise::adaptive;
  const bool repeat = exported.bank.dt_s > 0.0;
  const bool driven = exported.structure().acting_inputs() > 0;
  std::string text = std::string(repeat ? steps_repeat : steps_single) + samples_text + algebra_text + kalman_text +
                     mixing(exported) + probabilities_text + (adaptive ? noise_text : "") + step_text;
  const auto replace = [&](const char* mark, const char* by) { boost::algorithm::replace_all(text, mark, by); };
  replace("@INPUT_TERM@", driven ? input_term : "");
  replace("@NO_INPUT@", driven ? "" : "  (void)v;\n");
  replace("@PRIOR_SAMPLES@", adaptive ? "PRIOR_SAMPLES" : "0");
  replace("@ADAPT@", adaptive ? "  adapt_noise(filter, sensor);\n" : "");
  return text;
}

}  // namespace modebank::app::c_form
