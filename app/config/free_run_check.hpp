#pragma once

#include "filter/judge/run/free_run.hpp"
#include "ident/model/linear_model.hpp"

namespace modebank {

/// Throws ConfigurationError, naming the key, unless a free run of this model can start from so many samples.
void check_free_run(const LinearStructure& structure, const FreeRunOptions& options);

}  // namespace modebank
