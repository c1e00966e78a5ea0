#pragma once

#include "ident/batch_problem.hpp"

namespace modebank::batch {

/// Fits all windows of a chunk; `scratch` has scratch_doubles, aligned to 64 bytes. Compiled for every instruction set
/// that the machine may have; the best is chosen at run time.
using Kernel = void (*)(const Settings& settings, const Chunk& chunk, double* scratch, const Output& out);

/// Null for a shape they do not have.
Kernel convex_kernel(Loss loss, int regressors);
Kernel nonconvex_kernel(Loss loss, int regressors);
Kernel any_kernel(int regressors);

}  // namespace modebank::batch
