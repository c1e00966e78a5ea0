#include "io/import/split.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "io/import/stamp_check.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

using Eigen::VectorXd;
using Positions = std::vector<Index>;

struct Interval {
  double first_s = 0.0, end_s = 0.0;
};

double least(const VectorXd& time_s) { return time_s.array().isFinite().select(time_s, HUGE_VAL).minCoeff(); }
double largest(const VectorXd& time_s) { return time_s.array().isFinite().select(time_s, -HUGE_VAL).maxCoeff(); }

/// Time intervals of the blocks. The gaps between blocks belong to no interval. The last interval has no end.
std::vector<Interval> intervals(const RunStreams& run, const SplitOptions& options, double rate_hz) {
  const VectorXd &states = run.states.stream.time_s, &inputs = run.inputs.stream.time_s;
  const double first = std::max(least(states), least(inputs)), last = std::min(largest(states), largest(inputs));
  const double gap_s = static_cast<double>(options.gap_samples) *
                       (rate_hz > 0.0 ? 1.0 / rate_hz : median_step({inputs.begin(), inputs.end()}));
  std::vector<double> borders{first};
  if (options.kind == SplitKind::last) borders.push_back(last - (last - first) * options.last_percent / 100.0);
  for (int i = 1; options.kind == SplitKind::blocks && i < options.blocks; ++i)
    borders.push_back(first + (last - first) * i / options.blocks);
  borders.push_back(HUGE_VAL);
  std::vector<Interval> result;
  for (std::size_t i = 0; i + 1 < borders.size(); ++i) {
    result.push_back({borders[i], borders[i + 1] - gap_s});
    if (!(result.back().end_s > result.back().first_s))
      throw DataError(
          fmt::format("run \"{}\": a block of data.split is {:.4g} s long, but {:.4g} s (a window and its lags) are "
                      "dropped at its end; use fewer blocks, or a shorter window.length",
                      run.run, borders[i + 1] - borders[i], gap_s));
  }
  return result;
}

Positions within(const VectorXd& time_s, const Interval& interval) {
  Positions positions;
  for (Index k = 0; k < time_s.size(); ++k)
    if (time_s(k) >= interval.first_s && time_s(k) < interval.end_s) positions.push_back(k);
  return positions;
}

RunStreams block_of(const RunStreams& run, const Interval& interval) {
  RunStreams block = run;
  const Positions states = within(run.states.stream.time_s, interval),
                  inputs = within(run.inputs.stream.time_s, interval);
  if (states.empty() || inputs.empty())
    throw DataError(fmt::format("run \"{}\" has no samples in a block of data.split", run.run));
  take(block.states, states);
  take(block.inputs, inputs);
  for (std::vector<RunStreams::Companion>* columns : block.companions())
    for (RunStreams::Companion& column : *columns)
      column.values = VectorXd(column.values(column.with_states ? states : inputs));
  return block;
}

}  // namespace

std::vector<RunStreams> split_run(const RunStreams& run, const SplitOptions& options, double rate_hz) {
  if (options.kind == SplitKind::none) return {run};
  std::vector<RunStreams> blocks;
  for (const Interval& interval : intervals(run, options, rate_hz)) {
    blocks.push_back(block_of(run, interval));
    blocks.back().role = blocks.size() % 2 == 1 ? Role::train : Role::test;
    blocks.back().run = fmt::format("{}.b{}", run.run, blocks.size());
  }
  return blocks;
}

std::string proposed_split(Index samples, Index gap_samples) {
  constexpr Index most_blocks = 10, fewest_blocks = 4, gaps_per_block = 4;
  const Index blocks = std::min(most_blocks, samples / std::max<Index>(1, gaps_per_block * gap_samples) / 2 * 2);
  return blocks < fewest_blocks ? std::string("last 30 %") : fmt::format("blocks {}", blocks);
}

std::string split_note(const RunStreams& run, const std::vector<RunStreams>& blocks, const SplitOptions& options) {
  const std::string rest =
      fmt::format("{} samples (a window and its lags) are dropped in between", options.gap_samples);
  if (options.kind == SplitKind::last)
    return fmt::format("run {} is split: {} trains, its last {:g} %, {}, is held out; {}", run.run, blocks.front().run,
                       options.last_percent, blocks.back().run, rest);
  return fmt::format("run {} is split into {} blocks: {}.b1, .b3, ... train, {}.b2, .b4, ... are held out; {}", run.run,
                     blocks.size(), run.run, run.run, rest);
}

}  // namespace modebank
