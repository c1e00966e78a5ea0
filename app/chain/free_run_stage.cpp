#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "app/chain/stages.hpp"
#include "filter/judge/free_run.hpp"
#include "modebank/base/error.hpp"

namespace modebank {
namespace {

/// Runs side by side: each has its own random numbers.
template <class Predict>
std::vector<FreeRun> predict_runs(const std::vector<Trajectory>& runs, Predict predict) {
  std::vector<FreeRun> result(runs.size());
  tbb::parallel_for(std::size_t{0}, runs.size(), [&](std::size_t i) { result[i] = predict(runs[i]); });
  return result;
}

}  // namespace

void check_free_run(const LinearStructure& structure, const FreeRunOptions& options) {
  const Index fewest = fewest_start_samples(structure);
  if (options.samples > 0 && options.samples < fewest)
    throw ConfigurationError(
        fmt::format("filter.simulate = {}: a model with these lags starts from at least {} measured samples",
                    options.samples, fewest));
}

std::vector<FreeRun> free_runs(const Bank& bank, const std::vector<Trajectory>& runs, const FilterOptions& filter,
                               const FreeRunOptions& options) {
  if (options.samples == 0) return {};
  check_free_run(bank.structure, options);
  return predict_runs(runs, [&](const Trajectory& run) { return free_run(bank, run, filter, options); });
}

std::vector<FreeRun> free_runs(const DriftingModel& model, const std::vector<Trajectory>& runs,
                               const FreeRunOptions& options) {
  if (options.samples == 0) return {};
  check_free_run(model.structure, options);
  return predict_runs(runs, [&](const Trajectory& run) { return free_run(model, run, options); });
}

std::vector<std::string> remarks(const std::string& filter, const std::vector<Trajectory>& runs,
                                 const std::vector<FreeRun>& free_runs) {
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < free_runs.size(); ++i) {
    for (const std::string& note : free_runs[i].notes)
      if (filter == "bank")  // the others' are the same: of the data
        lines.push_back(fmt::format("free run of {}: run {} {}", filter, runs[i].run, note));
    if (const Index lost = free_runs[i].lost_paths; lost > 0)
      lines.push_back(fmt::format("free run of {}: run {}: {} sample paths left the finite range and were taken out",
                                  filter, runs[i].run, lost));
  }
  return lines;
}

}  // namespace modebank
