#pragma once

#include <string>

#include "io/archive/archive.hpp"

namespace modebank {

/// The summary's row of a filter over all runs of a role; null without.
const SummaryRow* pooled_row(const Archive& archive, const std::string& filter, Role role);

/// The row of a filter's mode over all runs of a role; null without. mode -1: the whole filter.
const DiagnosticsRow* diagnosis(const Archive& archive, const std::string& filter, Role role, Eigen::Index mode = -1);

/// The runs that filters are judged on: those held out, or, where nothing was, those they learned from.
Role judged_role(const Archive& archive);

/// Positions of the runs that have the role.
std::vector<std::size_t> positions_of(const Recording& recording, Role role);

/// "held-out" or "training".
const char* words_for(Role role);

/// "200,000 of 2,500,000".
std::string of_all(Eigen::Index part, Eigen::Index all);

/// "from 200,000 of 2,500,000 training transitions".
std::string learned_words(Eigen::Index learned, Eigen::Index all);

/// "3 modes drawn 32 % of the way to the model of all runs: ...".
std::string shrinking_words(const Shrinking& shrinking);

}  // namespace modebank
