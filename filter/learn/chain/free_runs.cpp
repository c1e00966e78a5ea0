#include "filter/learn/chain/free_runs.hpp"

#include <tbb/parallel_for.h>

namespace modebank {
namespace {

/// Each run has its own random numbers.
template <class Predict>
std::vector<FreeRun> predict_runs(const std::vector<Trajectory>& runs, const FreeRunOptions& options, Predict predict) {
  if (options.samples == 0) return {};
  std::vector<FreeRun> result(runs.size());
  tbb::parallel_for(std::size_t{0}, runs.size(), [&](std::size_t i) { result[i] = predict(runs[i]); });
  return result;
}

}  // namespace

std::vector<FreeRun> free_runs(const Bank& bank, const std::vector<Trajectory>& runs, const FilterOptions& filter,
                               const FreeRunOptions& options) {
  return predict_runs(runs, options, [&](const Trajectory& run) { return free_run(bank, run, filter, options); });
}

std::vector<FreeRun> free_runs(const DriftingModel& model, const std::vector<Trajectory>& runs,
                               const FreeRunOptions& options) {
  return predict_runs(runs, options, [&](const Trajectory& run) { return free_run(model, run, options); });
}

}  // namespace modebank
