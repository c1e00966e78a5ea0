#include "app/cli/check/check_suggestions.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "app/cli/check/check_output.hpp"
#include "app/cli/json_number.hpp"
#include "app/config/option_table.hpp"

namespace modebank::app {
namespace {

using nlohmann::json;

Config with(Config config, const Settings& settings) {
  const ChainOptions options = with_settings(chain_options(config), settings);
  config.data = options.data;
  config.window = options.window;
  config.bank.measurement_variance = options.bank.measurement_variance;
  config.mixture.selection.em.restarts = options.mixture.selection.em.restarts;
  return config;
}

std::string keys_text(const Config& config, const Trial& trial) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : changed_keys(config, trial.from, trial.to))
    keys.push_back(fmt::format("{} = {}", key, value));
  return fmt::format("{}", fmt::join(keys, ", "));
}

std::string gain_text(const PairedGain& gain) {
  return fmt::format("{:+.3f} +- {:.3f}", gain.gain, gain.standard_error);
}

std::string runs_text(const Suggestions& s) {
  return s.whole_runs ? fmt::format("{} training runs left out in turn", s.runs)
                      : fmt::format("parts of {} training run{} left out in turn", s.runs, s.runs == 1 ? "" : "s");
}

}  // namespace

std::string gain_reason(const Suggestions& suggestions, const Trial& trial) {
  return trial.unscored.empty() ? fmt::format("{} nats per sample on {}; {}", gain_text(trial.gain),
                                              runs_text(suggestions), reason_text(trial))
                                : fmt::format("not scored: {}", trial.unscored);
}

std::string reason_text(const Trial& trial) {
  switch (trial.change) {
    case Change::rate:
      return trial.from.window_length == trial.to.window_length
                 ? rate_reason(trial.advice)
                 : rate_reason(trial.advice) + "; there " + length_reason(trial.advice);
    case Change::lag:
      return "the inputs act at other times than their stamps";
    case Change::length:
      return length_reason(trial.advice);
    case Change::noise:
      return fmt::format("at rest ({:.1f} s of the training runs) the state has a standard deviation of {:.2g}",
                         trial.rest.duration_s, std::sqrt(trial.rest.variance));
    case Change::restarts:
      return "more random starts of mixture and bank";
    case Change::loss:
      break;
  }
  return loss_reason(trial.advice);
}

namespace {

std::string accepted_text(const Suggestions& s, const Config& config) {
  std::string text;
  int accepted = 0;
  for (const Trial& trial : s.trials) {
    if (!trial.accepted) continue;
    ++accepted;
    text += fmt::format("  {}: {} nats per sample; {}\n", keys_text(config, trial), gain_text(trial.gain),
                        reason_text(trial));
  }
  if (accepted > 1) text += fmt::format("  together: {} nats per sample\n", gain_text(s.together));
  return accepted > 0 ? text : "  nothing, because no other setting gains more than one standard error\n";
}

json gain_json(const PairedGain& gain) {
  return {{"gain", json_number(gain.gain)},
          {"standard_error", json_number(gain.standard_error)},
          {"samples", gain.samples}};
}

}  // namespace

KeyValues changed_keys(const Config& config, const Settings& from, const Settings& to) {
  Config stated = config;  // the settings contain a number, even if the key's value is `auto`
  if (from.window_length != to.window_length) stated.structure.length = LagChoice::number;
  if (from.window_step != to.window_step) stated.structure.step = LagChoice::number;
  const Config before = with(stated, from), after = with(stated, to);
  KeyValues keys;
  for (const char* key : {"data.rate_hz", "data.lag_s", "window.length", "window.step", "window.loss",
                          "bank.measurement_variance", "mixture.restarts"})
    if (const Option* option = find_option(key); option->get(before) != option->get(after))
      keys.emplace_back(key, option->get(after));
  return keys;
}

std::string suggestions_text(const Suggestions& s, const Config& config) {
  if (!s.unscored.empty())
    return fmt::format("\nsuggested\n  nothing, because nothing could be scored: {}\n", s.unscored);
  std::string text =
      fmt::format("\nsuggested, by {}, each in addition to those before\n{}", runs_text(s), accepted_text(s, config));
  std::vector<std::string> in_vain, unscored;
  for (const Trial& trial : s.trials) {
    if (trial.accepted) continue;
    if (trial.unscored.empty())
      in_vain.push_back(fmt::format("{} ({})", keys_text(config, trial), gain_text(trial.gain)));
    else
      unscored.push_back(fmt::format("{} ({})", keys_text(config, trial), trial.unscored));
  }
  if (!in_vain.empty()) text += fmt::format("no improvement from: {}\n", fmt::join(in_vain, "; "));
  if (!unscored.empty()) text += fmt::format("not scored: {}\n", fmt::join(unscored, "; "));
  return text;
}

json suggestions_json(const Suggestions& s, const Config& config) {
  json trials = json::array(), suggested = json::object();
  for (const Trial& trial : s.trials) {
    json entry = gain_json(trial.gain);
    for (const auto& [key, value] : changed_keys(config, trial.from, trial.to)) entry["keys"][key] = value;
    entry["accepted"] = trial.accepted;
    entry["reason"] = reason_text(trial);
    entry["unscored_because"] = trial.unscored;
    if (!trial.unscored.empty()) entry["gain"] = entry["standard_error"] = nullptr;
    trials.push_back(entry);
  }
  for (const auto& [key, value] : changed_keys(config, s.present, s.suggested)) suggested[key] = value;
  return {{"suggested", suggested},
          {"together", s.any() ? gain_json(s.together) : json(nullptr)},
          {"trials", trials},
          {"training_runs", s.runs},
          {"whole_runs_left_out", s.whole_runs},
          {"unscored_because", s.unscored}};
}

}  // namespace modebank::app
