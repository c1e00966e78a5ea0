#pragma once

#include <string>

#include "app/chain/listener.hpp"
#include "app/chain/stage_inputs.hpp"

/// Expected times of stages. With this information users can shorten long stages before these begin. The times are
/// processor seconds, fitted to docs/results/cost.md. They are right within a factor of three.
namespace modebank {

double expected_windows_s(const Recording& recording, const FitOptions& window);
double expected_mixture_s(const WindowFits& windows, const ClusterOptions& options);
/// Expected time of refinement. The competitor one_motion takes about as long.
double expected_learning_s(const Recording& recording, const LinearStructure& structure, const RefineOptions& options);

/// Prints one line of progress if `seconds` exceeds 30: "bank: expected to take 2 min of processor time; --bank.refine
/// none shortens this".
void tell_if_long(const Listener& listener, const std::string& stage, double seconds, const std::string& instead);

}  // namespace modebank
