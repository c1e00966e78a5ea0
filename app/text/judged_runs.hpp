#pragma once

#include <string>

#include "filter/learn/chain/progress.hpp"
#include "io/archive/archive.hpp"

namespace modebank {

/// The summary's row of a filter over all runs with a role; null if there is none.
const SummaryRow* pooled_row(const Archive& archive, const std::string& filter, Role role);

/// The row of a filter's mode over all runs with a role; null if there is none. mode -1 is the whole filter.
const DiagnosticsRow* diagnosis(const Archive& archive, const std::string& filter, Role role, Eigen::Index mode = -1);

/// The evaluation of a filter over all runs; null if there is none.
const FilterEvaluation* evaluation_of(const Archive& archive, const std::string& filter);

/// The role of the runs that filters are judged on: held-out runs, or training runs if none is held out.
Role judged_role(const Archive& archive);

/// Indices of the runs with this role.
std::vector<std::size_t> positions_of(const Recording& recording, Role role);

/// "held-out" or "training".
const char* words_for(Role role);

}  // namespace modebank
