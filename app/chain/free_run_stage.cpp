#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "app/chain/stages.hpp"
#include "filter/judge/run/free_run.hpp"

namespace modebank {

std::vector<FreeRun> free_runs(const Bank& bank, const std::vector<Trajectory>& runs, const FilterOptions& filter,
                               const FreeRunOptions& options) {
  if (options.samples == 0) return {};
  std::vector<FreeRun> result(runs.size());
  tbb::parallel_for(std::size_t{0}, runs.size(),
                    [&](std::size_t i) { result[i] = free_run(bank, runs[i], filter, options); });
  return result;
}

std::vector<std::string> remarks(const std::string& filter, const std::vector<Trajectory>& runs,
                                 const std::vector<FreeRun>& free_runs) {
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < free_runs.size(); ++i) {
    for (const std::string& note : free_runs[i].notes)
      if (filter == "bank")  // these remarks concern the data, so they are the same for all filters
        lines.push_back(fmt::format("free run of {}: run {} {}", filter, runs[i].run, note));
    if (const Index lost = free_runs[i].lost_paths; lost > 0)
      lines.push_back(fmt::format("free run of {}: run {}: {} sample paths left the finite range and were taken out",
                                  filter, runs[i].run, lost));
  }
  return lines;
}

}  // namespace modebank
