#include "filter/learn/likelihood/training_likelihood.hpp"

#include <tbb/parallel_for.h>

#include <cmath>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <utility>
#include <vector>

#include "filter/judge/evaluate.hpp"
#include "filter/judge/horizon.hpp"

namespace modebank {

using Eigen::Index;

Eigen::VectorXd look_ahead_scores(const Bank& bank, const Trajectory& run, const FilterOptions& options,
                                  const LookAhead& look) {
  if (look.samples < 1) throw std::invalid_argument("look-ahead learning needs a horizon of at least one sample");
  if (look.is_likelihood()) return log_densities(bank, run, options);
  const std::unique_ptr<ForecastingFilter> filter = forecasting_filter(bank, run, options);
  Eigen::VectorXd sums =
      look.counts_errors() ? Eigen::VectorXd::Zero(run.samples()) : log_densities(bank, run, options);
  Eigen::VectorXd error(run.state.rows());
  const Index stride = (look.samples + 3) / 4;
  Index first = 0;
  for (Index t = 0; t < filter->moments().count(); ++t) {
    filter->step_to(t);
    const Instant& moment = filter->moments().instants[static_cast<std::size_t>(t)];
    if (moment.starts) first = moment.sample;
    if (moment.sample < 0 || (moment.sample - first) % stride != 0) continue;
    filter->look_ahead(t, [&](Forecast& forecast, Index ahead, Index k) {
      const auto y = run.state.col(k);
      // One sample ahead, the filter itself has already computed the density of every sample.
      if ((ahead > 1 || look.counts_errors()) && missing_entries(y) == 0) {
        const double density = forecast.observe(y, error);
        sums(k) += static_cast<double>(stride) *
                   (look.counts_errors() ? -0.5 * error.cwiseQuotient(look.error_unit).squaredNorm() : density);
      }
      return ahead < look.samples;
    });
  }
  return sums / static_cast<double>(look.samples);
}

double look_ahead_score(const Bank& bank, const Trajectory& run, const FilterOptions& options, const LookAhead& look) {
  if (look.is_likelihood()) return log_likelihood(bank, run, options);
  double total = 0.0;
  for (const double value : look_ahead_scores(bank, run, options, look)) total += std::isnan(value) ? 0.0 : value;
  return total;
}

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
