#include "app/cli/summary_json.hpp"

#include <nlohmann/json.hpp>

#include "app/text/mode_names.hpp"
#include "app/text/motions.hpp"

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

json modes_json(const Archive& archive) {
  json list = json::array();
  for (const UsedMode& mode : used_modes(archive))
    list.push_back({{"mode", mode.mode},
                    {"name", mode_cell(archive.mode_names, mode.mode)},
                    {"motion", archive.bank->motion_of(mode.mode)},
                    {"use", mode.use},
                    {"stay_s", mode.stay_s}});
  return list;
}

json summary_motions(const Archive& archive) {
  json list = json::array();
  for (const Motion& motion : motions_of(archive))
    list.push_back({{"motion", motion.number},
                    {"title", motion.title()},
                    {"modes", motion.modes},
                    {"use", motion.use},
                    {"stay_s", motion.stay_s}});
  return list;
}

}  // namespace

json summary_json(const Archive& archive, const Settings& settings) {
  const FirstScreen screen = make_first_screen(archive, settings);
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
          {"modes", modes_json(archive)},
          {"motions", summary_motions(archive)},
          {"role", name_of(screen.role)}};
}

}  // namespace modebank::app
