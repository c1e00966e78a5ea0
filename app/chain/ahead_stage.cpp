// What filters predict several samples ahead, each by itself and all of them combined.
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <string>
#include <vector>

#include "app/chain/judged_runs.hpp"
#include "app/chain/stages.hpp"
#include "filter/judge/combination.hpp"
#include "filter/judge/drifting.hpp"
#include "filter/judge/finding.hpp"
#include "filter/judge/horizon.hpp"
#include "ident/base/work_counter.hpp"
#include "modebank/base/error.hpp"

namespace modebank {
namespace {

/// A filter of the archive as the chain runs it.
struct Forecaster {
  std::string name;
  Bank bank;  ///< of drifting: its sizes
  FilterOptions filter;
};

std::vector<Forecaster> forecasters_of(const Archive& archive, const FilterOptions& filter) {
  std::vector<Forecaster> all;
  if (archive.bank) all.push_back({"bank", *archive.bank, filter});
  for (const char* name : competitor_names)
    if (const std::optional<Bank> bank = archive.bank_of(name))
      all.push_back({name, *bank, competitor_filter(name, filter)});
  return all;
}

HorizonEvaluation predict(const Forecaster& by, const Archive& archive, const Trajectory& run,
                          const std::vector<Index>& horizons) {
  if (by.name == "drifting") return evaluate_horizons(*archive.drifting, run, by.filter.time_steps, horizons);
  return evaluate_horizons(by.bank, run, by.filter, horizons);
}

/// A horizon that no judged run reaches has no scores: an error where it was stated, else it is left out.
void keep_reached_horizons(Archive& archive, bool stated) {
  std::vector<Index> unreached;
  for (const HorizonRow& row : archive.horizons)
    if (row.filter == "bank" && row.run == "*" && row.role == judged_role(archive) && row.samples == 0)
      unreached.push_back(row.horizon);
  // Lags take more of a run than was known before it was modelled.
  if (stated && !unreached.empty())
    throw DataError(fmt::format(
        "filter.horizon = {}: no run reaches so many samples ahead of where the filter starts, its sample {}",
        unreached.front(), archive.bank->structure.first_transition() + 1));
  std::erase_if(archive.horizons, [&](const HorizonRow& row) {
    return std::find(unreached.begin(), unreached.end(), row.horizon) != unreached.end();
  });
}

}  // namespace

void score_ahead(const FilterOptions& filter, const ScoringOptions& scoring, Archive& archive) {
  archive.horizons.clear();
  archive.combination.clear();
  if (scoring.horizon == std::vector<Index>{1}) return;  // that the summary scores
  const std::vector<Trajectory>& runs = archive.recording->runs;
  const std::vector<Forecaster> all = forecasters_of(archive, filter);
  std::vector<std::string> names;
  for (const Forecaster& one : all) names.push_back(one.name);
  ForecastTables tables(names, runs);
  WorkCounter counter("runs predicted ahead", runs.size());
  for (const Role role : {Role::train, Role::test}) {
    tbb::parallel_for(std::size_t{0}, runs.size(), [&](std::size_t i) {
      if (runs[i].role != role) return;
      std::vector<HorizonEvaluation> said;
      for (const Forecaster& one : all) said.push_back(predict(one, archive, runs[i], scoring.horizon));
      tables.add(i, said);
      counter.add();
    });
    if (role == Role::train) tables.start_as_trained();
  }
  archive.horizons = tables.horizons();
  keep_reached_horizons(archive, scoring.horizon != ScoringOptions::default_horizon);
  archive.combination = tables.combination();
}

}  // namespace modebank
