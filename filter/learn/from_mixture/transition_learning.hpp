#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/step/bank.hpp"
#include "ident/model/local_model.hpp"

namespace modebank {

/// Added to every count of transitions between labels, so that no transition is impossible.
inline constexpr double label_count_smoothing = 0.1;

/// K x K counts of (label i, then label j) over neighbouring windows: same run, starts one `step` apart. `kept` holds
/// the mixture components that are modes (mode j is component kept[j]); labels M, -1: none. A window whose label is no
/// mode, as one that straddles a switch, counts as the last mode before it, so that the switch is counted once, after
/// it.
Eigen::MatrixXd count_label_transitions(const WindowFits& fits, const Eigen::VectorXi& labels,
                                        const std::vector<Index>& kept);

/// Row-normalised smoothed counts, brought from one window step (`step` transitions) to one transition: the diagonal
/// becomes T_ii^(1/step) and the rest of the row is scaled to keep the row's sum at one.
TransitionMatrix transition_from_counts(const Eigen::MatrixXd& counts, Index step);

}  // namespace modebank
