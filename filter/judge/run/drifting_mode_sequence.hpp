#pragma once

#include <Eigen/Core>

#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"
#include "modebank/filter/options.hpp"

namespace modebank {

/// The most probable sequence of modes (Viterbi) of a bank whose modes drift; -1 before the start. At each sample, a
/// mode has the theta that the filter had learned up to this sample with its own mode probabilities. The result is
/// exact without drift. With drift it is approximate, because another sequence of modes would have led to another
/// theta.
Eigen::VectorXi drifting_mode_sequence(const Bank& bank, const Trajectory& run, const FilterOptions& options);

}  // namespace modebank
