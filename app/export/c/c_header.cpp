#include <fmt/format.h>

#include <boost/algorithm/string.hpp>

#include "app/export/c/c_parts.hpp"
#include "app/export/names.hpp"

namespace modebank::app::c_form {
namespace {

/// A line of a comment per item, with its unit.
std::string channel_enum(const std::vector<Channel>& channels, const char* kind, const char* what) {
  if (channels.empty()) return "";
  std::vector<std::string> names;
  for (const Channel& channel : channels) names.push_back(channel.name);
  const std::vector<std::string> unique = identifiers(names, Language::c);
  std::string text = fmt::format("/* {} */\nenum {{\n", what);
  for (std::size_t i = 0; i < channels.size(); ++i)
    text += fmt::format("  $P_{}_{} = {}{} /* {} [{}] */\n", kind, unique[i], i, i + 1 < channels.size() ? "," : "",
                        c_comment(channels[i].name),
                        channels[i].unit.empty() ? "unit not stated" : c_comment(channels[i].unit));
  return text + "};\n\n";
}

std::string sizes(const ExportedBank& exported) {
  const LinearStructure& s = exported.structure();
  return fmt::format(R"c(enum {{
  $P_MODES = {},
  $P_STATES = {},       /* of x, lagged samples among them */
  $P_MEASUREMENTS = {}, /* of y */
  $P_INPUTS = {},       /* as they are recorded */
  $P_ACTING_INPUTS = {} /* of u, which acts on one step: lagged samples among them */
}};

)c",
                     exported.bank.mode_count(), s.dimension(), exported.bank.C.rows(), s.inputs, s.acting_inputs());
}

constexpr const char* types =
    R"c(/* What the filter says of one sample. What it does not know, before its start or where nothing was measured, is NaN. */
typedef struct {
  $p_real prediction[$P_STATES]; /* x before the measurement */
  $p_real innovation[$P_MEASUREMENTS]; /* measurement minus prediction */
  $p_real innovation_covariance[$P_MEASUREMENTS][$P_MEASUREMENTS]; /* of the prediction */
  $p_real state[$P_STATES]; /* x after the measurement */
  $p_real covariance[$P_STATES][$P_STATES]; /* and its covariance */
  $p_real mode_probability_predicted[$P_MODES]; /* before the measurement */
  $p_real mode_probability[$P_MODES]; /* after it */
  $p_real log_density; /* of the measurement's signals that are there, given what was known before [nats] */
  int steps; /* model steps from the sample before; 0: the filter (re)started here, or waits for a start */
} $p_estimate;

typedef struct {
  $p_real mean[$P_STATES];
  $p_real covariance[$P_STATES][$P_STATES];
} $p_gaussian;

/* One mode's step; of no interest outside. */
typedef struct {
  $p_gaussian predicted;
  $p_real gain[$P_STATES][$P_MEASUREMENTS];
  $p_real innovation[$P_MEASUREMENTS], decorrelated[$P_MEASUREMENTS];
  $p_real S[$P_MEASUREMENTS][$P_MEASUREMENTS], L[$P_MEASUREMENTS][$P_MEASUREMENTS], D[$P_MEASUREMENTS];
  $p_real log_likelihood;
} $p_step_of_mode;

/* All that a filter remembers, and its workspace. Copy it to look ahead. Nothing is kept elsewhere. */
typedef struct {
  int started;
  $p_gaussian mode[$P_MODES];
  $p_real mode_probability[$P_MODES];
  $p_real noise_scale, noise_samples; /* every mode's Q is multiplied by noise_scale */
  $p_real recorded[$P_INPUT_SAMPLES][$P_INPUT_ROOM]; /* inputs, newest first */
  $p_real measured[$P_MEASURED_SAMPLES][$P_MEASUREMENTS]; /* newest first */
  int samples, whole; /* how many are known, whole ones in a row; counted no further than a start needs */
  double time_s; /* of the last sample; always double, because float forgets milliseconds after some hours */
  $p_step_of_mode step[$P_MODES];
  $p_gaussian mixed[$P_MODES];
  $p_real predicted_probability[$P_MODES];
} $p_filter;

)c";

constexpr const char* functions = R"c(/* Forgets everything; call it before the first sample. */
void $p_restart($p_filter *filter);

/* The next sample: its time [s] (NaN: one period after the last), the inputs recorded at it (what is not finite: the
 * last known one still acts) and the measurements (NaN: missing). A time that is k periods after the last is k steps
 * under the inputs that acted; after more than 50 the filter starts anew from the next whole measurement. Times must
 * increase. `estimate` may be null. */
void $p_step($p_filter *filter, double time_s, const $p_real *input, const $p_real *measurement, $p_estimate *estimate);

/* The next `steps` samples, one period apart, without measurements: what will be measured, and its covariance.
 * `input`: steps x $P_INPUTS, those recorded at these samples; `mean`: steps x $P_MEASUREMENTS; `covariance`: steps x
 * $P_MEASUREMENTS x $P_MEASUREMENTS. The filter is left as it is; `ahead` is room for a copy of it. */
void $p_predict(const $p_filter *filter, $p_filter *ahead, int steps, const $p_real *input, $p_real *mean,
    $p_real *covariance);
)c";

}  // namespace

std::string c_comment(const std::string& text) {
  return boost::algorithm::replace_all_copy(comment_text(text), "$", "_");
}

std::string opening(const ExportedBank& exported, const char* what) {
  const LinearStructure& s = exported.structure();
  const std::string lag =
      exported.input_lag_s == 0.0 ? ""
      : exported.input_lag_s > 0.0
          ? fmt::format("\n * Inputs act {0:.17g} s late: at time t give it those recorded at t - {0:.17g} s.",
                        exported.input_lag_s)
          : fmt::format(
                "\n * Inputs act {0:.17g} s before they are recorded: at time t give it those recorded at t + {0:.17g} "
                "s;"
                "\n * live, measurements wait that long for them.",
                -exported.input_lag_s);
  std::string remarks;
  for (const std::string& remark : exported.remarks()) remarks += "\n * " + c_comment(remark) + ".";
  return fmt::format(
      "/* Calibration: {}\n *\n * {}, made by modebank {} of\n * {}, filter {}, SHA-256\n * {}\n * {}\n * dt_s = "
      "{:.17g} "
      "s; "
      "{} state lag(s), {} input lag(s), delay {} sample(s){}{}\n * {} */\n\n",
      c_comment(exported.verdict_text()), what, c_comment(exported.provenance.modebank_version),
      c_comment(exported.archive), exported.filter, exported.sha256, exported_equation, exported.bank.dt_s,
      s.state_lags, s.input_lags, s.input_delay, lag, remarks, transition_meaning);
}

std::string header(const ExportedBank& exported, const std::string& prefix) {
  const std::string guard = boost::algorithm::to_upper_copy(prefix) + "_H";
  const LinearStructure& s = exported.structure();
  std::string text = opening(exported, "A bank of modes and its filter");
  text += fmt::format("#ifndef {0}\n#define {0}\n\n#ifdef __cplusplus\nextern \"C\" {{\n#endif\n\n", guard);
  text += "typedef $real $p_real;\n\n" + sizes(exported);
  text += channel_enum(exported.recorded_inputs, "INPUT", "Places in `input`");
  text += channel_enum(exported.measurements, "MEASUREMENT", "Places in `measurement`");
  text += channel_enum(exported.states, "STATE", "Places in x");
  text += fmt::format("enum {{\n  $P_INPUT_SAMPLES = {},\n  $P_INPUT_ROOM = {},\n  $P_MEASURED_SAMPLES = {}\n}};\n\n",
                      s.input_delay + s.input_lags, std::max<Index>(1, s.inputs), s.state_lags);
  text += types;
  text += functions;
  return text + fmt::format("\n#ifdef __cplusplus\n}}\n#endif\n\n#endif /* {} */\n", guard);
}

}  // namespace modebank::app::c_form
