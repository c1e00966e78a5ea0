#include "app/config/free_run_check.hpp"

#include <fmt/format.h>

#include "modebank/base/error.hpp"

namespace modebank {

void check_free_run(const LinearStructure& structure, const FreeRunOptions& options) {
  const Index fewest = fewest_start_samples(structure);
  if (options.samples > 0 && options.samples < fewest)
    throw ConfigurationError(
        fmt::format("filter.simulate = {}: with these lags a free run starts from at least {} measured samples",
                    options.samples, fewest));
}

}  // namespace modebank
