#pragma once

#include <Eigen/Core>

#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"
#include "modebank/filter/options.hpp"

namespace modebank {

/// The most probable sequence of modes (Viterbi) of a bank whose modes drift; -1 before the start. Every mode counts at
/// every sample as the filter had it, with what its theta had learned until then from the filter's own probabilities:
/// exact where nothing drifts, an approximation where a sequence would have taught its modes otherwise.
Eigen::VectorXi drifting_mode_sequence(const Bank& bank, const Trajectory& run, const FilterOptions& options);

}  // namespace modebank
