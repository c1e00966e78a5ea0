#pragma once

#include <string>

#include "app/chain/listener.hpp"
#include "app/chain/stage_inputs.hpp"

/// How long stages are expected to take, so that those that take long can be left out before they begin. Figures are
/// processor seconds, fitted to docs/results/cost.md; they are right within a factor of three.
namespace modebank {

double expected_windows_s(const Recording& recording, const FitOptions& window);
double expected_mixture_s(const WindowFits& windows, const ClusterOptions& options);
/// Refinement takes so long, and the competitor one_motion about the same.
double expected_learning_s(const Recording& recording, const LinearStructure& structure, const RefineOptions& options);

/// One line of progress where `seconds` are more than 30: "bank: begins, expected to take 2 min of processor time;
/// --bank.refine none leaves this out".
void tell_if_long(const Listener& listener, const std::string& stage, double seconds, const std::string& instead);

}  // namespace modebank
