#pragma once

#include "filter/judge/run/evaluate.hpp"
#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"

namespace modebank {

/// Fills smoothed_state, smoothed_covariance and viterbi_mode of an evaluation by evaluate_run with the same arguments.
///
/// Smoothing is Kim's (1994), "Dynamic linear models with Markov-switching", J. Econometrics 60, eq. 2.17 to 2.24, on
/// the variant's filtered estimates of each mode: for every pair (mode j now, mode k next) a step of Rauch, Tung &
/// Striebel's smoother, then one estimate per mode by moments; for one mode that smoother itself. The mode sequence is
/// the most probable one where the state is measured exactly; otherwise each mode keeps the Kalman filter of its best
/// history alone (Pavlovic, Rehg & MacCormick 2000, NIPS 13). Neither crosses a new start of the filter. With adaptive
/// noise both take the filter's own scale at every moment for known. salvi2025 has no smoother: its smoothed arrays
/// stay empty. Cost: at most K^2 Kalman steps per sample, and K of them where histories and pairs differ by much.
void smooth_run(const Bank& bank, const Trajectory& run, const FilterOptions& options, RunEvaluation& evaluation);

}  // namespace modebank
