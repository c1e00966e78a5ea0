#include "app/cli/summary_json.hpp"

#include <nlohmann/json.hpp>

#include "app/text/mode_families.hpp"
#include "app/text/mode_names.hpp"

namespace modebank::app {
namespace {

using nlohmann::json;

json errors_json(const std::vector<ErrorAhead>& errors) {
  json list = json::array();
  for (const ErrorAhead& error : errors)
    list.push_back({{"steps", error.steps},
                    {"rmse", error.rmse},
                    {"combined", error.combined},
                    {"fit_percent", error.fit_percent}});
  return list;
}

json forecasts_json(const std::vector<NamedForecast>& forecasts) {
  json list = json::array();
  for (const NamedForecast& forecast : forecasts)
    list.push_back({{"steps", forecast.steps},
                    {"filter", forecast.filter},
                    {"rmse", forecast.rmse},
                    {"c_filter", forecast.c_filter}});
  return list;
}

json modes_json(const Archive& archive, const std::vector<ModeFamily>& families) {
  json list = json::array();
  const std::vector<Index> family = family_of_modes(families);
  for (const UsedMode& mode : used_modes(archive))
    list.push_back({{"mode", mode.mode},
                    {"name", mode_cell(archive.mode_names, mode.mode)},
                    {"family", family[static_cast<std::size_t>(mode.mode)]},
                    {"use", mode.use},
                    {"stay_s", mode.stay_s}});
  return list;
}

json summary_families(const std::vector<ModeFamily>& families) {
  json list = json::array();
  for (const ModeFamily& family : families)
    list.push_back(
        {{"title", family.title()}, {"modes", family.modes}, {"use", family.use}, {"stay_s", family.stay_s}});
  return list;
}

}  // namespace

json summary_json(const Archive& archive, const Settings& settings) {
  const FirstScreen screen = make_first_screen(archive, settings);
  const std::vector<ModeFamily> families = mode_families(archive);
  json answer = nullptr;
  if (screen.answer) answer = name_of(*screen.answer);
  return {{"read", screen.read},
          {"structure", screen.structure},
          {"finding", screen.finding},
          {"band", screen.band},
          {"mean", screen.mean},
          {"warning", screen.warning},
          {"use", screen.use},
          {"forecasts", forecasts_json(screen.forecasts)},
          {"answer", answer},
          {"equations", archive.finding ? archive.finding->equations : std::vector<std::string>()},
          {"filter", screen.filter},
          {"competitor", screen.competitor},
          {"gain", screen.gain},
          {"gain_error", screen.gain_error},
          {"coverage", screen.coverage},
          {"coverage_lower", screen.coverage_lower},
          {"coverage_upper", screen.coverage_upper},
          {"verdict", name_of(screen.verdict)},
          {"errors", errors_json(screen.errors)},
          {"free_run_start", screen.free_run_start},
          {"fit", screen.fit},
          {"modes", modes_json(archive, families)},
          {"families", summary_families(families)},
          {"role", name_of(screen.role)}};
}

}  // namespace modebank::app
