#include "filter/learn/chain/forecasters.hpp"

#include "filter/judge/decide/finding.hpp"
#include "filter/judge/run/drifting.hpp"
#include "filter/learn/chain/free_runs.hpp"
#include "filter/learn/chain/inputs.hpp"

namespace modebank {

std::unique_ptr<AnyFilter> Forecaster::start() const {
  return drifting ? any_filter(*drifting) : any_filter(bank, filter);
}

HorizonEvaluation Forecaster::ahead(const Trajectory& run, const std::vector<Index>& horizons) const {
  return drifting ? evaluate_horizons(*drifting, run, horizons) : evaluate_horizons(bank, run, filter, horizons);
}

std::vector<FreeRun> Forecaster::free(const std::vector<Trajectory>& runs, const FreeRunOptions& options) const {
  return drifting ? free_runs(*drifting, runs, options) : free_runs(bank, runs, filter, options);
}

std::vector<Forecaster> forecasters_of(const Learning& learned, const FilterOptions& filter) {
  std::vector<Forecaster> all;
  if (learned.bank) all.push_back({"bank", *learned.bank, {}, filter});
  for (const char* name : competitor_names)
    if (const std::optional<Bank> bank = learned.bank_of(name)) {
      all.push_back({name, *bank, {}, competitor_filter(name, filter)});
      if (all.back().name == "drifting") all.back().drifting = learned.drifting;
    }
  return all;
}

}  // namespace modebank
