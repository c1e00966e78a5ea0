#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/step/bank.hpp"
#include "ident/model/local_model.hpp"

namespace modebank {

/// Added to every count of label transitions, so that no transition is impossible.
inline constexpr double label_count_smoothing = 0.1;

/// K x K counts of (label i, then label j) over neighbouring windows: same run, starts one `step` apart. `kept` lists
/// the mixture components that are modes (mode j is component kept[j]). Labels: M values, -1 for none. A window without
/// a mode, such as one that contains a switch, counts as the previous mode. So the switch is counted once, after that
/// window.
Eigen::MatrixXd count_label_transitions(const WindowFits& fits, const Eigen::VectorXi& labels,
                                        const std::vector<Index>& kept);

/// Normalises smoothed counts by rows and converts from one window step (`step` transitions) to one transition. The
/// diagonal becomes T_ii^(1/step); the rest of the row is scaled so that the row sums to one.
TransitionMatrix transition_from_counts(const Eigen::MatrixXd& counts, Index step);

}  // namespace modebank
