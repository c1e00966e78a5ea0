// Predictions several samples ahead, by each filter and by the combination of all filters.
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "app/chain/stages.hpp"
#include "app/text/judged_runs.hpp"
#include "filter/judge/combination.hpp"
#include "filter/judge/horizon.hpp"
#include "ident/base/work_counter.hpp"
#include "modebank/base/error.hpp"

namespace modebank {
namespace {

/// Removes horizons that no judged run reaches, because these have no scores. `stated`: the configuration names the
/// horizons, so an unreachable one throws.
void keep_reached_horizons(Archive& archive, bool stated) {
  std::vector<Index> unreached;
  for (const HorizonRow& row : archive.horizons)
    if (row.filter == "bank" && row.run == "*" && row.role == judged_role(archive) && row.samples == 0)
      unreached.push_back(row.horizon);
  // Lags shorten a run only when the run is modelled, so horizons cannot be checked earlier.
  if (stated && !unreached.empty())
    throw DataError(
        fmt::format("filter.horizon = {}: no run is long enough; the filter starts at sample {}. Give a smaller number",
                    unreached.front(), archive.bank->structure.first_transition() + 1));
  std::erase_if(archive.horizons, [&](const HorizonRow& row) {
    return std::find(unreached.begin(), unreached.end(), row.horizon) != unreached.end();
  });
}

}  // namespace

void score_ahead(const FilterOptions& filter, const ScoringOptions& scoring, Archive& archive) {
  const std::vector<Trajectory>& runs = archive.recording->runs;
  const std::vector<LearnedFilter> all = learned_filters(archive, filter);
  std::vector<std::string> names;
  for (const LearnedFilter& one : all) names.push_back(one.name);
  std::vector<Index> horizons = scoring.horizon;
  horizons.push_back(1);  // the live filters need the weights for one step ahead
  std::sort(horizons.begin(), horizons.end());
  horizons.erase(std::unique(horizons.begin(), horizons.end()), horizons.end());
  ForecastTables tables(names, runs, start_weights(archive.left_out, horizons, names));
  WorkCounter counter("runs predicted ahead", runs.size());
  for (const Role role : {Role::train, Role::test}) {
    tbb::parallel_for(std::size_t{0}, runs.size(), [&](std::size_t i) {
      if (runs[i].role != role) return;
      std::vector<HorizonEvaluation> said;
      for (const LearnedFilter& one : all) said.push_back(evaluate_horizons(one.bank, runs[i], one.options, horizons));
      tables.add(i, said);
      counter.add();
    });
    if (role == Role::train) tables.start_as_trained();
  }
  archive.horizons.clear();
  if (scoring.horizon != std::vector<Index>{1})
    archive.horizons = tables.horizons();  // the archive's summary contains the one-step scores
  std::erase_if(archive.horizons, [&](const HorizonRow& row) {
    return std::find(scoring.horizon.begin(), scoring.horizon.end(), row.horizon) == scoring.horizon.end();
  });
  keep_reached_horizons(archive, scoring.horizon != ScoringOptions::default_horizon);
  archive.combination = tables.combination();
}

}  // namespace modebank
