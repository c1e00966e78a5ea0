#pragma once

#include "ident/fit/detail/batch/problem.hpp"

namespace modebank::batch {

/// Fits all windows of a chunk. `scratch` has scratch_doubles numbers, aligned to 64 bytes. The function is compiled
/// for every instruction set that the machine may have; the best one is chosen at run time.
using Kernel = void (*)(const Settings& settings, const Chunk& chunk, double* scratch, const Output& out);

/// The kernel for a loss and a number of regressors; null above max_regressors.
Kernel find_kernel(Loss loss, int regressors);

}  // namespace modebank::batch
