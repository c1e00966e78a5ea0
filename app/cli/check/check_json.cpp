#include <nlohmann/json.hpp>

#include "app/cli/check/check_output.hpp"
#include "app/cli/json_number.hpp"

namespace modebank::app {
namespace {

using nlohmann::json;

json sampling_json(const SamplingCheck& s) {
  return {{"samples", s.samples},
          {"duration_s", json_number(s.duration_s)},
          {"rate_hz", json_number(s.rate_hz)},
          {"jitter", json_number(s.jitter)},
          {"gaps", s.gaps},
          {"longest_gap_s", json_number(s.longest_gap_s)},
          {"repeated_times", s.repeated_times},
          {"backward_times", s.backward_times},
          {"missing_times", s.missing_times},
          {"missing_samples", s.missing_samples},
          {"repeated_samples", json_number(s.repeated_samples)}};
}

json channel_json(const std::string& name, const ChannelCheck& c, double saturated) {
  return {{"name", name},
          {"missing", c.missing},
          {"least", json_number(c.least)},
          {"largest", json_number(c.largest)},
          {"mean", json_number(c.mean)},
          {"sd", json_number(c.sd)},
          {"quantum", json_number(c.quantum)},
          {"levels", c.levels},
          {"repeated", json_number(c.repeated)},
          {"outliers", c.outliers},
          {"saturated", json_number(saturated)}};
}

json lag_json(const RunLag& lag) {
  return {{"status", name_of(lag.status)},
          {"lag_s", json_number(lag.lag_s)},
          {"lag_standard_error_s", json_number(lag.lag_standard_error_s)},
          {"time_constant_s", json_number(lag.time_constant_s)},
          {"r_squared", json_number(lag.r_squared)}};
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
          {"still", json_number(run.commands.still)},
          {"longest_constant_s", json_number(run.commands.longest_constant_s)},
          {"changes", json_number(run.commands.changes)},
          {"rest_s", json_number(run.rest.duration_s)},
          {"rest_mean", json_numbers(run.rest.mean)},
          {"rest_sd", json_numbers(run.rest.sd)},
          {"excitation_order", run.excitation},
          {"transitions", run.transitions},
          {"windows", run.windows.windows},
          {"deficient_windows", json_number(run.windows.share())},
          {"lag", lag_json(run.lag)},
          {"problem", run.problem}};
}

json pooled_json(const PooledEstimate& pooled) {
  return {{"mean", json_number(pooled.mean)},
          {"standard_error", json_number(pooled.standard_error)},
          {"between_runs_sd", json_number(pooled.between_sd)},
          {"runs", pooled.count}};
}

json lags_json(const LagReport& lag) {
  json scores = json::array();
  for (const LagScore& score : lag.scores)
    scores.push_back({{"correction", name_of(score.correction)},
                      {"transitions", score.transitions},
                      {"log_score", json_number(score.log_score)},
                      {"rmse", json_number(score.rmse)},
                      {"gain", json_number(score.gain)},
                      {"gain_standard_error", json_number(score.gain_standard_error)}});
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
    entry["saturation_low"] = json_number(channel.limits.low);
    entry["saturation_high"] = json_number(channel.limits.high);
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
