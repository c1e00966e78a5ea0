#include "app/cli/new_data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>

#include "io/archive/load_averaged.hpp"
#include "io/archive/load_lag.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {

bool given(const CommandLine& line, const std::string& key) {
  return std::any_of(line.overrides.begin(), line.overrides.end(), [&](const auto& o) { return o.first == key; });
}

void turn_to_new_files(const CommandLine& line, DataOptions& data) {
  const std::string& archive = line.files.front();
  if (!given(line, "data.root")) data.root = std::filesystem::current_path().string();
  if (!given(line, "data.states") && !data.states.empty())
    throw ConfigurationError(
        fmt::format("data.states: the states of {} came from separate files ({}); name those of the new inputs, or "
                    "give --data.states= if they are columns of the same files",
                    archive, data.states));
  if (!given(line, "data.train")) data.train.clear();
  if (!given(line, "data.test")) data.test.clear();
  if (!given(line, "data.missing")) data.missing = Missing::predict;
  data.truth.clear();
  data.label.clear();
  if (!given(line, "data.split")) data.split = {};
}

AveragedColumns take_sampling(const CommandLine& line, const OpenArchive& archive, double period_s, DataOptions& data) {
  AveragedColumns averaged;
  if (data.rate_hz > 0.0) averaged = load_averaged(archive);
  if (!data.lag_auto || given(line, "data.lag_s")) return averaged;
  const std::optional<LagReport> lag = load_lag(archive);
  data.lag_auto = false;
  data.lag_s = 0.0;
  if (!lag || lag->correction == LagCorrection::none) return averaged;
  averaged.further_lag_s = 0.5 * period_s;
  data.lag_s = lag->lag.mean - averaged.further_lag_s;
  return averaged;
}

}  // namespace modebank::app
