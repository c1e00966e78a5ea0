#include "filter/training_likelihood.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "filter/scalar_imm.hpp"

namespace modebank {
namespace {

constexpr std::size_t runs_together = 8;  // the lanes of the widest register

}  // namespace

double training_log_likelihood(const Bank& bank, const Recording& recording, const FilterOptions& options) {
  std::vector<const Trajectory*> runs;
  for (const Trajectory& run : recording.runs)
    if (run.role == Role::train) runs.push_back(&run);
  // Only what goes through the lanes gains by company; other runs are better spread over threads.
  const std::size_t together = scalar_imm::can_step(bank, options) ? runs_together : 1;
  std::vector<double> of_group((runs.size() + together - 1) / together);
  tbb::parallel_for(std::size_t{0}, of_group.size(), [&](std::size_t g) {
    const auto first = runs.begin() + static_cast<std::ptrdiff_t>(g * together);
    const std::vector<const Trajectory*> group(
        first, first + static_cast<std::ptrdiff_t>(std::min(together, runs.size() - g * together)));
    const std::vector<double> values = log_likelihoods(std::vector<const Bank*>(group.size(), &bank), group, options);
    of_group[g] = std::accumulate(values.begin(), values.end(), 0.0);
  });
  return std::accumulate(of_group.begin(), of_group.end(), 0.0);
}

}  // namespace modebank
