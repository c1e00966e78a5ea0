#include <fmt/format.h>

#include "app/config/config_file.hpp"
#include "app/config/option_table.hpp"
#include "app/report/page/numbers.hpp"
#include "app/report/page/run_sections.hpp"
#include "app/text/structure_text.hpp"
#include "app/text/summary_text.hpp"

namespace modebank::app::report {
namespace {

using nlohmann::json;

/// Keys whose values are not the defaults, in the order of the option table.
json changed_settings(const std::string& config) {
  const Config defaults{};
  const std::map<std::string, std::string> values = resolved_values(config);
  json changed = json::array();
  for (const Option& option : option_table()) {
    const auto value = values.find(option.key);
    if (value == values.end() || value->second == option.get(defaults) || !option.stage) continue;
    changed.push_back(
        {{"key", option.key}, {"value", value->second}, {"standard", option.get(defaults)}, {"help", option.help}});
  }
  return changed;
}

std::string roles_text(const Recording& recording) {
  const auto runs = [&](Role role) {
    return std::count_if(recording.runs.begin(), recording.runs.end(),
                         [role](const Trajectory& run) { return run.role == role; });
  };
  return fmt::format("{} training ({} transitions), {} held out ({})", runs(Role::train),
                     count_text(recording.transitions(Role::train)), runs(Role::test),
                     count_text(recording.transitions(Role::test)));
}

std::string windows_line(const WindowFits& fits) {
  return fmt::format("{} of {} transitions, model {}, loss {}", count_text(fits.count()), fits.length, fits.model,
                     name_of(fits.loss));
}

json inputs_of(const Provenance& provenance) {
  json inputs = json::array();
  for (const InputFile& file : provenance.inputs)
    inputs.push_back(
        {{"path", file.path}, {"bytes", count(static_cast<long long>(file.bytes))}, {"sha256", file.sha256}});
  return inputs;
}

json structures_of(const Archive& archive) {
  json rows = json::array();
  if (!archive.structure) return rows;
  for (const StructureScore& s : archive.structure->scores)
    rows.push_back({{"state_lags", count(s.state_lags)},
                    {"input_lags", count(s.input_lags)},
                    {"input_delay", count(s.input_delay)},
                    {"log_score", number(s.log_score, fmt::format("{:.4f}", s.log_score))},
                    {"loss", estimate(s.loss, s.loss_standard_error)},
                    {"rmse", number_list(s.rmse)},
                    {"drifting", number(s.drifting_score)},
                    {"one_motion", number(s.one_motion_score)},
                    {"modes", number(s.modes_score)},
                    {"taken_by", taken_by(s)},
                    {"chosen", s.chosen}});
  return rows;
}

}  // namespace

nlohmann::json origin_section(const Archive& archive) {
  const Provenance& provenance = archive.provenance;
  json versions = json::array();
  for (const auto& [name, version] : provenance.versions) versions.push_back({name, version});
  json known = json::array();
  if (archive.recording) {
    known.push_back({"Runs", roles_text(*archive.recording)});
    known.push_back({"Sample period", number_text(archive.recording->median_period_s()) + " s (median)"});
  }
  if (archive.structure) known.push_back({"Lags and delay", structure_sentence(*archive.structure, acted_on(archive))});
  if (archive.windows) known.push_back({"Windows", windows_line(*archive.windows)});
  return {{"created", provenance.created},
          {"facts", known},
          {"version", provenance.modebank_version},
          {"command", provenance.command_line},
          {"config_hash", provenance.config_hash},
          {"data_hash", provenance.data_hash},
          {"versions", versions},
          {"inputs", inputs_of(provenance)},
          {"config", archive.config},
          {"changed", changed_settings(archive.config)},
          {"structures", structures_of(archive)},
          {"summary", summary_text(archive, time_unit(resolved_values(archive.config)))}};
}

}  // namespace modebank::app::report
