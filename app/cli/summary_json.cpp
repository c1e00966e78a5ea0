#include "app/cli/summary_json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "app/chain/mode_names.hpp"

namespace modebank::app {
namespace {

using nlohmann::json;

/// JSON has no NaN.
json number(double value) { return std::isfinite(value) ? json(value) : json(nullptr); }

json numbers(const Eigen::VectorXd& values) {
  json list = json::array();
  for (const double value : values) list.push_back(number(value));
  return list;
}

json errors_json(const std::vector<ErrorAhead>& errors) {
  json list = json::array();
  for (const ErrorAhead& error : errors)
    list.push_back({{"steps", error.steps}, {"bank", numbers(error.bank)}, {"other", numbers(error.other)}});
  return list;
}

json modes_json(const Archive& archive) {
  json list = json::array();
  for (const UsedMode& mode : used_modes(archive))
    list.push_back({{"mode", mode.mode},
                    {"name", mode_cell(archive.mode_names, mode.mode)},
                    {"use", number(mode.use)},
                    {"stay_s", number(mode.stay_s)}});
  return list;
}

}  // namespace

json summary_json(const Archive& archive, const Settings& settings) {
  const FirstScreen screen = make_first_screen(archive, settings);
  json answer = nullptr;
  if (screen.answer) answer = name_of(*screen.answer);
  return {{"read", screen.read},
          {"finding", screen.finding},
          {"band", screen.band},
          {"mean", screen.mean},
          {"warning", screen.warning},
          {"next", screen.next},
          {"answer", answer},
          {"competitor", screen.competitor},
          {"gain", number(screen.gain)},
          {"gain_error", number(screen.gain_error)},
          {"coverage", number(screen.coverage)},
          {"coverage_lower", number(screen.coverage_lower)},
          {"coverage_upper", number(screen.coverage_upper)},
          {"verdict", name_of(screen.verdict)},
          {"errors", errors_json(screen.errors)},
          {"free_run_start", screen.free_run_start},
          {"fit", numbers(screen.fit)},
          {"other_fit", numbers(screen.other_fit)},
          {"modes", modes_json(archive)},
          {"role", name_of(screen.role)}};
}

}  // namespace modebank::app
