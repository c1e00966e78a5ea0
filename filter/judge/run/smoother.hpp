#pragma once

#include "filter/judge/run/evaluate.hpp"
#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"

namespace modebank {

/// Fills smoothed_state, smoothed_covariance and viterbi_mode of an evaluation. The evaluation comes from evaluate_run
/// with the same arguments.
///
/// Smoothing follows Kim (1994), "Dynamic linear models with Markov-switching", J. Econometrics 60, eq. 2.17 to 2.24,
/// on the variant's filtered estimates of each mode. Every pair (mode j now, mode k next) has one step of the
/// Rauch-Tung-Striebel smoother; then the pairs of each mode are merged by moments. With one mode this is exactly the
/// Rauch-Tung-Striebel smoother. The mode sequence is the most probable one if the state is measured exactly. Otherwise
/// each mode keeps only the Kalman filter of its best history (Pavlovic, Rehg & MacCormick 2000, NIPS 13). Smoothing
/// and the mode sequence both stop at a restart of the filter. With adaptive noise both use the filter's scale at every
/// moment. salvi2025 has no smoother: its smoothed arrays stay empty. The cost is at most K^2 Kalman steps per sample.
/// It is K steps if one history and one pair clearly win.
void smooth_run(const Bank& bank, const Trajectory& run, const FilterOptions& options, RunEvaluation& evaluation);

}  // namespace modebank
