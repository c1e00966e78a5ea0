#pragma once

#include <optional>
#include <string>

#include "io/archive/archive.hpp"

namespace modebank {

/// A filter's row of the summary for all runs of a role; null if there is none.
const SummaryRow* pooled_row(const Archive& archive, const std::string& filter, Role role);

struct ScoresAhead {
  double log_score = 0.0;  ///< [nats/sample]
  Eigen::VectorXd rmse;    ///< n_y [state unit]
  double coverage_95 = 0.0;
};
/// Scores of a filter some steps ahead, for all runs of a role.
std::optional<ScoresAhead> scores_ahead(const Archive& archive, const std::string& filter, Role role,
                                        Eigen::Index steps);

/// The row of one mode of a filter for all runs of a role; null if there is none. Mode -1 means the whole filter.
const DiagnosticsRow* diagnosis(const Archive& archive, const std::string& filter, Role role, Eigen::Index mode = -1);

/// The evaluation of a filter on all runs; null if there is none.
const FilterEvaluation* evaluation_of(const Archive& archive, const std::string& filter);

/// Role of the runs on which filters are judged: held-out runs, or training runs if no run is held out.
Role judged_role(const Archive& archive);

/// Indices of the runs with this role.
std::vector<std::size_t> positions_of(const Recording& recording, Role role);

/// "held-out" or "training".
const char* words_for(Role role);

/// Whether several runs are stretches of one drive: parts of one file whose names differ only after the last dot.
bool are_stretches(const Recording& recording);

/// "run", "runs", "stretch" or "stretches".
const char* noun_of_runs(Eigen::Index count, bool stretches);

}  // namespace modebank
