// Settings that `check` can suggest: options of a chain with values that suit the data.
#include <algorithm>
#include <cmath>

#include "app/chain/stage_inputs.hpp"
#include "app/chain/stages.hpp"
#include "app/cli/check/suggest.hpp"
#include "io/import/import.hpp"

namespace modebank {

Settings settings_of(const ChainOptions& options) {
  return {options.data.rate_hz,
          options.data.lag_auto,
          options.data.lag_s,
          options.window.length,
          options.window.step,
          options.window.loss,
          options.bank.measurement_variance,
          options.mixture.selection.em.restarts};
}

ChainOptions with_settings(ChainOptions options, const Settings& settings) {
  options.data.rate_hz = settings.rate_hz;
  options.data.lag_auto = settings.lag_auto;
  options.data.lag_s = settings.lag_s;
  options.window.length = settings.window_length;
  options.window.step = settings.window_step;
  options.window.loss = settings.loss;
  options.bank.measurement_variance = settings.measurement_variance;
  if (options.mixture.selection.em.restarts != settings.restarts)
    options.bank.em.restarts = refinement_restarts(settings.restarts);
  options.mixture.selection.em.restarts = settings.restarts;
  return options;
}

RestNoise rest_noise(const DataCheck& check) {
  RestNoise noise;
  for (const RunReport& run : check.runs) {
    const RestCheck& rest = run.rest;
    if (run.role != Role::train || rest.sd.size() != 1 || !std::isfinite(rest.sd(0))) continue;
    noise.duration_s += rest.duration_s;
    noise.variance += rest.duration_s * rest.sd(0) * rest.sd(0);
  }
  if (noise.duration_s > 0.0) noise.variance /= noise.duration_s;
  return noise;
}

bool Suggestions::any() const {
  return std::any_of(trials.begin(), trials.end(), [](const Trial& trial) { return trial.accepted; });
}

std::optional<FoundStructure> find_structure(const ChainOptions& options, const Listener& listener) {
  const std::optional<StructureInputs> inputs = chain_inputs(options).structure;
  if (!inputs) return std::nullopt;
  return search_structure(import_data(options.data).recording, *inputs, listener);
}

ChainOptions with_found(ChainOptions options, const std::optional<FoundStructure>& found) {
  if (found) static_cast<LearningOptions&>(options) = with_structure(options, *found);
  return options;
}

}  // namespace modebank
