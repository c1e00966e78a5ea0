#pragma once

#include <memory>
#include <string>
#include <vector>

#include "filter/judge/run/free_run.hpp"
#include "filter/judge/run/horizon.hpp"
#include "filter/learn/chain/parts.hpp"
#include "filter/step/any_filter.hpp"

namespace modebank {

/// A learned filter with the options to run it.
struct Forecaster {
  std::string name;
  Bank bank;
  FilterOptions filter;

  std::unique_ptr<AnyFilter> start() const;
  HorizonEvaluation ahead(const Trajectory& run, const std::vector<Index>& horizons) const;
  std::vector<FreeRun> free(const std::vector<Trajectory>& runs, const FreeRunOptions& options) const;
};

/// The bank and those competitors that exist. `filter`: options of the bank's filter.
std::vector<Forecaster> forecasters_of(const Learning& learned, const FilterOptions& filter);

}  // namespace modebank
