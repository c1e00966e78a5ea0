#pragma once

#include "filter/judge/horizon.hpp"
#include "ident/model/linear_model.hpp"

namespace modebank {

/// Throws ConfigurationError with the key if a free run of this model needs more measured samples at its start than
/// configured.
void check_free_run(const LinearStructure& structure, const FreeRunOptions& options);

}  // namespace modebank
