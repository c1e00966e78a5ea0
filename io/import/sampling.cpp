#include "io/import/sampling.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace modebank {

namespace {

using Times = std::vector<const Eigen::VectorXd*>;

/// Whether a column that changes does so at every sample. False for values that are held for several samples, such as
/// those of a slower sensor or a test signal: these rarely change twice in a row. A missing value counts as held.
bool moves_at_each_sample(const std::vector<const Stream*>& streams, Index row) {
  Index changes = 0, again = 0;
  for (const Stream* stream : streams) {
    const auto values = stream->values.row(row);
    const auto changed = [&](Index k) { return std::abs(values(k) - values(k - 1)) > 0.0; };
    for (Index k = 2; k < stream->time_s.size(); ++k) {
      if (!changed(k - 1)) continue;
      ++changes;
      again += changed(k) ? 1 : 0;
    }
  }
  return 2 * again > changes;
}

/// Indices of the columns whose values are averaged.
std::vector<Index> averaged_rows(const std::vector<const Stream*>& streams, double rate_hz, std::size_t rows,
                                 const std::vector<Index>* learned) {
  Times times;
  for (const Stream* stream : streams) times.push_back(&stream->time_s);
  std::vector<Index> result;
  if (!is_averaged_at(rate_hz, median_period_s(times))) return result;
  if (learned) return *learned;
  for (Index i = 0; i < static_cast<Index>(rows); ++i)
    if (moves_at_each_sample(streams, i)) result.push_back(i);
  return result;
}

std::string averaging_note(const LogSampling& sampling, const DataOptions& options) {
  std::vector<std::string> averaged, held;
  const auto add = [&](const std::vector<std::string>& names, const std::vector<Index>& rows) {
    for (std::size_t i = 0; i < names.size(); ++i)
      (std::count(rows.begin(), rows.end(), static_cast<Index>(i)) > 0 ? averaged : held).push_back(names[i]);
  };
  add(options.state, sampling.averaged.states);
  add(options.input, sampling.averaged.inputs);
  const std::string delay =
      held.empty() ? ""
                   : fmt::format(", which delays them by half a step ({:.3g} s) against {} (held values are picked)",
                                 0.5 / sampling.rate_hz, fmt::join(held, ", "));
  return fmt::format("at {:.4g} Hz {} {} the mean over the step that ends at each sample{}", sampling.rate_hz,
                     fmt::join(averaged, ", "), averaged.size() == 1 ? "is" : "are", delay);
}

LogSampling sampling_of(const std::vector<RunStreams>& runs, const DataOptions& options, const AveragedColumns* learned,
                        std::vector<std::string>& notes) {
  std::vector<const Stream*> states, inputs;
  Times times;
  for (const RunStreams& run : runs) {
    states.push_back(&run.states.stream);
    inputs.push_back(&run.inputs.stream);
    times.push_back(&run.inputs.stream.time_s);
  }
  constexpr double many_steps = 20.0;  // if one model step contains this number of the log's steps, their scatter
                                       // hardly matters
  LogSampling sampling{options.rate_hz, step_scatter(times)};
  const double period_s = median_period_s(times);
  if (!(sampling.rate_hz > 0.0)) return sampling;
  if (period_s * sampling.rate_hz * many_steps <= 1.0) sampling.step_scatter = 0.0;
  sampling.averaged = {
      averaged_rows(states, sampling.rate_hz, options.state.size(), learned ? &learned->states : nullptr),
      averaged_rows(inputs, sampling.rate_hz, options.input.size(), learned ? &learned->inputs : nullptr),
      learned ? learned->further_lag_s : 0.0};
  if (sampling.averaged.any()) notes.push_back(averaging_note(sampling, options));
  return sampling;
}

}  // namespace

LogSampling choose_sampling(const std::vector<RunStreams>& runs, const DataOptions& options,
                            const AveragedColumns* learned, std::vector<std::string>& notes) {
  LogSampling sampling = sampling_of(runs, options, learned, notes);
  if (sampling.step_scatter <= most_step_scatter)
    sampling.step_scatter = 0.0;
  else
    notes.push_back(
        fmt::format("steps scatter by {:.0f} % of their median, but a model has one step length, so modes are not "
                    "judged; log at even steps",
                    100.0 * sampling.step_scatter));
  return sampling;
}

}  // namespace modebank
