#include "io/import/run_streams.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "io/import/sampling.hpp"
#include "io/import/stamp_check.hpp"
#include "io/table/stamp.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

using Eigen::VectorXd;

std::string span(const FileStream& source) {
  return fmt::format("{} to {} s", source.time_text(0), source.time_text(source.stream.time_s.size() - 1));
}

void check_order(const FileStream& source) {
  const VectorXd& time_s = source.stream.time_s;
  for (Index k = 1; k < time_s.size(); ++k)
    if (!(time_s(k) > time_s(k - 1)))
      throw DataError(fmt::format("{}:{}: column {}: time goes backwards or repeats: {} after {}{}", source.file,
                                  source.line[static_cast<std::size_t>(k)], source.time_column, source.time_text(k),
                                  source.time_text(k - 1), disorder_hint(source, k)));
}

/// Indices of the samples in order of time. Samples with equal times stay in the order of the file.
std::vector<Index> order_of(const VectorXd& time_s) {
  std::vector<Index> order(static_cast<std::size_t>(time_s.size()));
  std::iota(order.begin(), order.end(), Index{0});
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return time_s(a) < time_s(b); });
  order.erase(std::unique(order.begin(), order.end(), [&](Index a, Index b) { return time_s(a) == time_s(b); }),
              order.end());
  return order;
}

void check_samples(const RunStreams& run, Index samples, double lag_s) {
  if (samples >= 2) return;
  const std::string lag = lag_s == 0.0 ? "" : fmt::format(", lag {} s", lag_s);
  throw DataError(fmt::format("run \"{}\" has {} sample{}, but needs at least two; states {} ({}), inputs {} ({}){}{}",
                              run.run, samples, samples == 1 ? "" : "s", span(run.states), run.states.file,
                              span(run.inputs), run.inputs.file, lag,
                              samples == 0 ? ": the streams do not overlap" : ""));
}

}  // namespace

void take(FileStream& source, const std::vector<Index>& positions) {
  source.stream = {source.stream.time_s(positions), source.stream.values(Eigen::all, positions)};
  std::vector<std::uint64_t> line;
  for (const Index k : positions) line.push_back(source.line[static_cast<std::size_t>(k)]);
  source.line = std::move(line);
}

std::string FileStream::time_text(Index k) const {
  const double time_s = stream.time_s(k);
  if (origin_ns == 0 || std::isnan(time_s)) return fmt::format("{}", time_s);
  return seconds_text(origin_ns + std::llround(time_s * 1e9));
}

void put_in_order(FileStream& source, Disorder disorder) {
  if (disorder == Disorder::error) return check_order(source);
  take(source, order_of(source.stream.time_s));
}

void put_in_order(RunStreams& run, Disorder disorder) {
  if (disorder == Disorder::error) {
    check_order(run.states);
    check_order(run.inputs);
    return;
  }
  const std::vector<Index> states = order_of(run.states.stream.time_s), inputs = order_of(run.inputs.stream.time_s);
  take(run.states, states);
  take(run.inputs, inputs);
  for (std::vector<RunStreams::Companion>* columns : run.companions())
    for (RunStreams::Companion& column : *columns)
      column.values = VectorXd(column.values(column.with_states ? states : inputs));
}

std::vector<bool> kept_samples(const RunStreams& run, const Trajectory& joined) {
  std::vector<bool> kept;
  for (const RunStreams::Companion& where : run.where) {
    const Stream stream{where.with_states ? run.states.stream.time_s : run.inputs.stream.time_s,
                        where.values.transpose()};
    const Eigen::MatrixXd values = where.with_states ? interpolate(stream, joined.time_s) : hold(stream, joined.time_s);
    for (const double value : values.reshaped()) kept.push_back(value >= 1.0);
  }
  return kept;
}

Trajectory join_run(const RunStreams& run, const DataOptions& options, const LogSampling& sampling,
                    double estimated_lag_s) {
  const Stream &states = run.states.stream, &inputs = run.inputs.stream;
  const double lag_s = options.lag_auto ? estimated_lag_s : options.lag_s;
  Trajectory joined;
  joined.run = run.run;
  joined.role = run.role;
  joined.lag_s = lag_s;
  joined.time_origin_ns = run.states.origin_ns;
  joined.file = run.inputs.file;
  joined.time_s = joint_times(states.time_s, inputs.time_s, {sampling.rate_hz, lag_s});
  const AveragedColumns& averaged = sampling.averaged;
  const double step_s = sampling.rate_hz > 0.0 ? 1.0 / sampling.rate_hz : 0.0;
  if (averaged.any() && joined.time_s.size() > 0)  // the first time is not the end of a whole step
    joined.time_s = joined.time_s.tail(joined.time_s.size() - 1).eval();
  check_samples(run, joined.time_s.size(), lag_s);
  joined.state = interpolate(states, joined.time_s);
  average_rows(states, averaged.states, joined.time_s, step_s, joined.state);
  blank_gaps(states.time_s, joined.time_s, joined.state);
  if (averaged.any()) blank_gaps(states.time_s, joined.time_s.array() - step_s, joined.state);
  joined.input = options.lag_auto && lag_s != 0.0 ? hold_mid_transition(inputs, joined.time_s, lag_s)
                                                  : hold(inputs, joined.time_s.array() - lag_s);
  const VectorXd recorded_s = joined.time_s.array() - lag_s - averaged.further_lag_s;
  average_rows(inputs, averaged.inputs, recorded_s, step_s, joined.input);
  joined.truth.resize(static_cast<Index>(run.truth.size()), run.truth.empty() ? 0 : joined.time_s.size());
  for (std::size_t i = 0; i < run.truth.size(); ++i) {
    const Stream truth{run.truth[i].with_states ? states.time_s : inputs.time_s, run.truth[i].values.transpose()};
    const auto row = static_cast<Index>(i);
    const bool is_mean = std::count(averaged.states.begin(), averaged.states.end(), row) > 0;
    joined.truth.row(row) = is_mean ? average_ending(truth, joined.time_s, step_s) : interpolate(truth, joined.time_s);
  }
  return joined;
}

}  // namespace modebank
