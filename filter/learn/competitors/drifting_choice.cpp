#include <limits>
#include <optional>
#include <vector>

#include "filter/learn/competitors/drifting.hpp"
#include "filter/learn/refine/learning_part.hpp"
#include "ident/data/stretch.hpp"
#include "ident/fit/global_model.hpp"
#include "modebank/base/error.hpp"

namespace modebank {
namespace {

using Eigen::Index;

constexpr Index most_asked_transitions = 20000;
constexpr double least_wandering_gain = 0.02;  // [nats/sample]

struct Wanderer {
  LinearStructure structure;
  Wandering wandering;
};

/// The candidates. The first one is kept if no other candidate gains.
std::vector<Wanderer> candidates_of(const LinearStructure& structure) {
  const LinearStructure one_lag = structure.with_one_lag();
  std::vector<Wanderer> candidates{{structure, Wandering::all}};
  if (one_lag != structure) candidates.push_back({one_lag, Wandering::all});
  for (const Wanderer& with : std::vector<Wanderer>(candidates)) {
    LinearStructure constant = with.structure;
    constant.intercept = true;
    candidates.push_back({constant, Wandering::constant});
    if (with.structure.inputs > 0) candidates.push_back({with.structure, Wandering::gain});
  }
  return candidates;
}

}  // namespace

DriftingGrid coarse_drifting_grid() {
  return {{0.0, 1e-4, 1e-3, 1e-2}, {0.0, 1e-2, 1.0}, {1.0, 0.97}, {0.7, 0.85, 0.93, 0.97}, {0.0, 4.0, 10.0}, {1e-3}};
}

double drifting_training_score(const Recording& recording, Index latest, const LinearStructure& structure,
                               const DriftingGrid& grid, Wandering wandering) {
  const Recording part = from_common_start(recording, latest - structure.first_transition());
  try {
    return learn_drifting(part, fit_global(part, structure), structure, {1}, grid, wandering).drift.tuning.log_score;
  } catch (const DataError&) {
    return -std::numeric_limits<double>::infinity();
  }
}

Bank learn_likeliest_drifting(const Recording& recording, const GlobalModel& global, const LinearStructure& structure,
                              const std::vector<Index>& horizons) {
  const std::optional<Recording> fewer = learning_part(recording, most_asked_transitions, 1);
  const std::vector<Wanderer> candidates = candidates_of(structure);
  const Wanderer* chosen = &candidates.front();
  DriftingGrid grid = coarse_drifting_grid();
  grid.p0.push_back(10.0);  // each run learns its own coefficients, so differences between runs do not change this
                            // comparison
  double best = -std::numeric_limits<double>::infinity();
  for (const Wanderer& candidate : candidates) {
    const double score = drifting_training_score(fewer ? *fewer : recording, structure.first_transition(),
                                                 candidate.structure, grid, candidate.wandering);
    if (!(score > best)) continue;
    best = &candidate == &candidates.front() ? score + least_wandering_gain : score;
    chosen = &candidate;
  }
  if (chosen == &candidates.front()) return learn_drifting(recording, global, structure, horizons);
  return learn_drifting(recording, fit_global(recording, chosen->structure), chosen->structure, horizons, {},
                        chosen->wandering);
}

}  // namespace modebank
