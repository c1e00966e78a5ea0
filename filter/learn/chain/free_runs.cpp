#include "filter/learn/chain/free_runs.hpp"

#include <tbb/parallel_for.h>

namespace modebank {

std::vector<FreeRun> free_runs(const Bank& bank, const std::vector<Trajectory>& runs, const FilterOptions& filter,
                               const FreeRunOptions& options) {
  if (options.samples == 0) return {};
  std::vector<FreeRun> result(runs.size());
  tbb::parallel_for(std::size_t{0}, runs.size(),
                    [&](std::size_t i) { result[i] = free_run(bank, runs[i], filter, options); });
  return result;
}

}  // namespace modebank
