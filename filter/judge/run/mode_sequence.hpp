#pragma once

#include <Eigen/Core>

#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"
#include "modebank/filter/options.hpp"

namespace modebank {

/// The most probable sequence of modes of a run (Viterbi), N; -1 before the filter's start. Each mode predicts a sample
/// from the filter's own estimate, in which the sequences up to this sample are mixed. This is exact while the state is
/// known (R = 0, no missing samples), since it is then the same for every sequence; else it is an approximation. A
/// restart of the filter begins a new sequence.
Eigen::VectorXi mode_sequence(const Bank& bank, const Trajectory& run, const FilterOptions& options);

}  // namespace modebank
