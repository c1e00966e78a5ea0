#include <nlohmann/json.hpp>

#include "app/cli/check/check_output.hpp"

namespace modebank::app {
namespace {

using nlohmann::json;

json sampling_json(const SamplingCheck& s) {
  return {{"samples", s.samples},
          {"duration_s", s.duration_s},
          {"rate_hz", s.rate_hz},
          {"jitter", s.jitter},
          {"gaps", s.gaps},
          {"longest_gap_s", s.longest_gap_s},
          {"repeated_times", s.repeated_times},
          {"backward_times", s.backward_times},
          {"missing_times", s.missing_times},
          {"missing_samples", s.missing_samples},
          {"repeated_samples", s.repeated_samples}};
}

json channel_json(const std::string& name, const ChannelCheck& c, double saturated) {
  return {{"name", name},           {"missing", c.missing},  {"least", c.least},
          {"largest", c.largest},   {"mean", c.mean},        {"sd", c.sd},
          {"quantum", c.quantum},   {"levels", c.levels},    {"repeated", c.repeated},
          {"outliers", c.outliers}, {"saturated", saturated}};
}

json lag_json(const RunLag& lag) {
  return {{"status", name_of(lag.status)},
          {"lag_s", lag.lag_s},
          {"lag_standard_error_s", lag.lag_standard_error_s},
          {"time_constant_s", lag.time_constant_s},
          {"r_squared", lag.r_squared}};
}

json run_json(const DataCheck& check, const RunReport& run) {
  json states = json::array(), inputs = json::array();
  for (std::size_t i = 0; i < run.state.size(); ++i)
    states.push_back(channel_json(check.channels[i].channel.name, run.state[i], run.state_saturated[i]));
  for (std::size_t i = 0; i < run.input.size(); ++i)
    inputs.push_back(
        channel_json(check.channels[run.state.size() + i].channel.name, run.input[i], run.input_saturated[i]));
  return {{"run", run.run},
          {"role", name_of(run.role)},
          {"inputs_sampling", sampling_json(run.inputs)},
          {"states_sampling", sampling_json(run.states)},
          {"states", states},
          {"inputs", inputs},
          {"still", run.commands.still},
          {"longest_constant_s", run.commands.longest_constant_s},
          {"changes", run.commands.changes},
          {"rest_s", run.rest.duration_s},
          {"rest_mean", run.rest.mean},
          {"rest_sd", run.rest.sd},
          {"excitation_order", run.excitation},
          {"transitions", run.transitions},
          {"windows", run.windows.windows},
          {"deficient_windows", run.windows.share()},
          {"lag", lag_json(run.lag)},
          {"problem", run.problem}};
}

json pooled_json(const PooledEstimate& pooled) {
  return {{"mean", pooled.mean},
          {"standard_error", pooled.standard_error},
          {"between_runs_sd", pooled.between_sd},
          {"runs", pooled.count}};
}

json lags_json(const LagReport& lag) {
  json scores = json::array();
  for (const LagScore& score : lag.scores)
    scores.push_back({{"correction", name_of(score.correction)},
                      {"transitions", score.transitions},
                      {"log_score", score.log_score},
                      {"rmse", score.rmse},
                      {"gain", score.gain},
                      {"gain_standard_error", score.gain_standard_error}});
  return {{"correction", name_of(lag.correction)}, {"lag_s", pooled_json(lag.lag)}, {"scores", scores}};
}

}  // namespace

json check_json(const DataCheck& check, const std::vector<std::string>& findings) {
  json runs = json::array(), channels = json::array();
  for (const RunReport& run : check.runs) runs.push_back(run_json(check, run));
  for (const ChannelSummary& channel : check.channels) {
    json entry = channel_json(channel.channel.name, channel.values, channel.saturated);
    entry["kind"] = channel.is_state ? "state" : "input";
    entry["saturation_soft"] = channel.limits.soft;
    entry["saturation_low"] = channel.limits.low;
    entry["saturation_high"] = channel.limits.high;
    channels.push_back(entry);
  }
  return {{"usable", check.unusable.empty()},
          {"unusable_because", unusable_text(check)},
          {"window_length", check.window_length},
          {"runs", runs},
          {"channels", channels},
          {"lag", check.has_lag ? lags_json(check.lag) : json(nullptr)},
          {"findings", findings}};
}

}  // namespace modebank::app
