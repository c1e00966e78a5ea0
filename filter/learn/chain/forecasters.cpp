#include "filter/learn/chain/forecasters.hpp"

#include "filter/judge/decide/finding.hpp"
#include "filter/learn/chain/free_runs.hpp"
#include "filter/learn/chain/inputs.hpp"

namespace modebank {

std::unique_ptr<AnyFilter> Forecaster::start() const { return any_filter(bank, filter); }

HorizonEvaluation Forecaster::ahead(const Trajectory& run, const std::vector<Index>& horizons) const {
  return evaluate_horizons(bank, run, filter, horizons);
}

std::vector<FreeRun> Forecaster::free(const std::vector<Trajectory>& runs, const FreeRunOptions& options) const {
  return free_runs(bank, runs, filter, options);
}

std::vector<Forecaster> forecasters_of(const Learning& learned, const FilterOptions& filter) {
  std::vector<Forecaster> all;
  if (learned.bank) all.push_back({"bank", *learned.bank, filter});
  for (const char* name : competitor_names)
    if (const std::optional<Bank> bank = learned.bank_of(name)) all.push_back({name, *bank, competitor_filter(name)});
  return all;
}

}  // namespace modebank
