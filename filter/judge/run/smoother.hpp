#pragma once

#include "filter/judge/run/evaluate.hpp"
#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"

namespace modebank {

/// Fills smoothed_state, smoothed_covariance and viterbi_mode of an evaluation by evaluate_run with the same arguments.
///
/// Smoothing follows Kim (1994), "Dynamic linear models with Markov-switching", J. Econometrics 60, eq. 2.17 to 2.24,
/// on the variant's filtered estimates of each mode. Every pair (mode j now, mode k next) has one step of the
/// Rauch-Tung-Striebel smoother; then each mode's pairs are merged by moments. With one mode it is that smoother
/// itself.
/// The mode sequence is the most probable one if the state is measured exactly. Otherwise each mode keeps only the
/// Kalman filter of its best history (Pavlovic, Rehg & MacCormick 2000, NIPS 13).
/// Neither crosses a restart of the filter. With adaptive noise both use the filter's scale at every moment. salvi2025
/// has no smoother: its smoothed arrays stay empty. Cost: at most K^2 Kalman steps per sample, and K where histories
/// and pairs differ much.
void smooth_run(const Bank& bank, const Trajectory& run, const FilterOptions& options, RunEvaluation& evaluation);

}  // namespace modebank
