#include "io/import/sampling.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace modebank {

namespace {

using Times = std::vector<const Eigen::VectorXd*>;

/// Whether a column changes with every sample while it changes at all: one that is held for several samples, as a
/// slower sensor's value or a test signal's level, rarely changes twice in a row.
bool moves_at_each_sample(const std::vector<const Stream*>& streams, Index row) {
  Index changes = 0, again = 0;
  for (const Stream* stream : streams) {
    const auto changed = [&](Index k) { return stream->values(row, k) != stream->values(row, k - 1); };
    for (Index k = 2; k < stream->time_s.size(); ++k) {
      if (!changed(k - 1)) continue;
      ++changes;
      again += changed(k) ? 1 : 0;
    }
  }
  return 2 * again > changes;
}

std::vector<bool> averaged_rows(const std::vector<const Stream*>& streams, double rate_hz, std::size_t rows) {
  constexpr double faster = 1.5;  // than the new rate
  Times times;
  for (const Stream* stream : streams) times.push_back(&stream->time_s);
  const double period_s = median_period_s(times);
  std::vector<bool> result(rows, false);
  if (!(period_s > 0.0) || rate_hz * period_s * faster > 1.0) return result;
  for (std::size_t i = 0; i < rows; ++i) result[i] = moves_at_each_sample(streams, static_cast<Index>(i));
  return result;
}

std::string averaging_note(const LogSampling& sampling, const DataOptions& options) {
  std::vector<std::string> averaged, held;
  for (std::size_t i = 0; i < sampling.states.size(); ++i)
    (sampling.states[i] ? averaged : held).push_back(options.state[i]);
  for (std::size_t i = 0; i < sampling.inputs.size(); ++i)
    (sampling.inputs[i] ? averaged : held).push_back(options.input[i]);
  const std::string delay =
      held.empty() ? ""
                   : fmt::format(", which delays them by half a step ({:.3g} s) against {} (held values are picked)",
                                 0.5 / sampling.rate_hz, fmt::join(held, ", "));
  return fmt::format("at {:.4g} Hz {} {} the mean over the step that ends at each sample{}", sampling.rate_hz,
                     fmt::join(averaged, ", "), averaged.size() == 1 ? "is" : "are", delay);
}

LogSampling sampling_of(const std::vector<RunStreams>& runs, const DataOptions& options,
                        std::vector<std::string>& notes) {
  std::vector<const Stream*> states, inputs;
  Times times;
  for (const RunStreams& run : runs) {
    states.push_back(&run.states.stream);
    inputs.push_back(&run.inputs.stream);
    times.push_back(&run.inputs.stream.time_s);
  }
  constexpr double many_steps = 20.0;  // of the log in one: whose scatter is then small beside it
  LogSampling sampling{options.rate_hz, step_scatter(times)};
  const double period_s = median_period_s(times);
  if (!(sampling.rate_hz > 0.0)) return sampling;
  if (period_s * sampling.rate_hz * many_steps <= 1.0) sampling.step_scatter = 0.0;
  sampling.states = averaged_rows(states, sampling.rate_hz, options.state.size());
  sampling.inputs = averaged_rows(inputs, sampling.rate_hz, options.input.size());
  if (sampling.averages()) notes.push_back(averaging_note(sampling, options));
  return sampling;
}

}  // namespace

bool LogSampling::averages() const {
  return std::count(states.begin(), states.end(), true) + std::count(inputs.begin(), inputs.end(), true) > 0;
}

LogSampling choose_sampling(const std::vector<RunStreams>& runs, const DataOptions& options,
                            std::vector<std::string>& notes) {
  LogSampling sampling = sampling_of(runs, options, notes);
  if (sampling.step_scatter <= most_step_scatter)
    sampling.step_scatter = 0.0;
  else
    notes.push_back(
        fmt::format("steps scatter by {:.0f} % of their median: a model holds for one step length, so modes are not "
                    "judged; log at even steps",
                    100.0 * sampling.step_scatter));
  return sampling;
}

}  // namespace modebank
