#include "filter/learn/likelihood/training_likelihood.hpp"

#include <tbb/parallel_for.h>

#include <numeric>
#include <utility>
#include <vector>

namespace modebank {

double training_log_likelihood(const Bank& bank, const Recording& recording, const FilterOptions& options,
                               const LookAhead& look) {
  std::vector<double> of_run(recording.runs.size(), 0.0);
  tbb::parallel_for(std::size_t{0}, of_run.size(), [&](std::size_t i) {
    if (recording.runs[i].role == Role::train) of_run[i] = look_ahead_score(bank, recording.runs[i], options, look);
  });
  return std::accumulate(of_run.begin(), of_run.end(), 0.0);
}

BankGradient training_gradient(const Bank& bank, const Recording& recording, const FilterOptions& options) {
  std::vector<const Trajectory*> runs;
  for (const Trajectory& run : recording.runs)
    if (run.role == Role::train) runs.push_back(&run);
  std::vector<BankGradient> of_run(runs.size());
  tbb::parallel_for(std::size_t{0}, runs.size(),
                    [&](std::size_t i) { of_run[i] = log_likelihood_gradient(bank, *runs[i], options); });
  for (std::size_t i = 1; i < of_run.size(); ++i) of_run[0] += of_run[i];
  return std::move(of_run.at(0));
}

}  // namespace modebank
