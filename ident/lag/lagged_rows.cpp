#include "ident/lag/lagged_rows.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace modebank {
namespace {

using Eigen::MatrixXd;

constexpr Index most_entries = 4'000'000;
constexpr Index rows_together = 500;  // number of rows that are kept or dropped together
constexpr Index folds_of_parts = 5;

LinearStructure widest_of(const Recording& recording, const StructureRanges& ranges, bool intercept) {
  LinearStructure widest;
  widest.states = recording.state_count();
  widest.inputs = recording.input_count();
  widest.intercept = intercept;
  widest.state_lags = ranges.state_lags.high;
  widest.input_lags =
      std::min(ranges.input_lags.high + ranges.input_delay.high, std::max(Index{1}, ranges.memory + 1)) -
      ranges.input_delay.low;
  widest.input_delay = ranges.newest;
  return widest;
}

/// Finite rows, in the order of the runs.
struct GatheredRows {
  std::vector<Transitions> blocks;
  std::vector<Index> run_of_block;
  Index rows = 0, runs = 0;
  double share = 0.0;
};

GatheredRows gather(const Recording& recording, const LinearStructure& widest) {
  GatheredRows gathered;
  const LinearStructure narrowest = widest.with_one_lag();
  const Index all = recording.transitions(Role::train);
  const Index stride = 1 + all * widest.regressors() / most_entries;
  Index possible = 0;
  for (const Trajectory& run : recording.runs) {
    if (run.role != Role::train) continue;
    const Index before = gathered.rows;
    for (Index start = 0; start < run.transitions(); start += rows_together * stride) {
      const Index count = std::min(rows_together, run.transitions() - start);
      possible += std::ssize(usable_rows(stack_transitions(run, start, count, narrowest)));
      const Transitions stacked = stack_transitions(run, start, count, widest);
      const std::vector<Index> kept = usable_rows(stacked);
      if (kept.empty()) continue;
      gathered.blocks.push_back({stacked.regressors(kept, Eigen::all), stacked.increments(kept, Eigen::all)});
      gathered.run_of_block.push_back(gathered.runs);
      gathered.rows += std::ssize(kept);
    }
    if (gathered.rows > before) ++gathered.runs;
  }
  if (possible > 0) gathered.share = static_cast<double>(gathered.rows) / static_cast<double>(possible);
  return gathered;
}

/// Run of each row, in the order of the rows.
std::vector<Index> runs_of(const GatheredRows& gathered) {
  std::vector<Index> runs;
  for (std::size_t b = 0; b < gathered.blocks.size(); ++b)
    runs.insert(runs.end(), static_cast<std::size_t>(gathered.blocks[b].count()), gathered.run_of_block[b]);
  return runs;
}

/// Replaces the older states by differences. Scales the columns to unit root mean square, and to zero mean if there is
/// a constant.
void transform(LaggedRows& rows) {
  const Index n = rows.states;
  for (Index j = rows.ranges.state_lags.high * n - 1; j >= n; --j) rows.X.col(j) = rows.X.col(j - n) - rows.X.col(j);
  for (Index j = 0; j < rows.X.cols(); ++j) {
    auto column = rows.X.col(j);
    if (rows.intercept && j + 1 < rows.X.cols()) column.array() -= column.mean();
    const double scale = column.stableNorm() / std::sqrt(static_cast<double>(rows.count()));
    if (scale > 0.0 && std::isfinite(scale)) column /= scale;
  }
}

void put_rows(const GatheredRows& gathered, const std::vector<Index>& order, Index columns, LaggedRows& rows) {
  MatrixXd X(gathered.rows, columns), Y(gathered.rows, rows.states);
  Index first = 0;
  for (const Transitions& of_block : gathered.blocks) {
    X.middleRows(first, of_block.count()) = of_block.regressors;
    Y.middleRows(first, of_block.count()) = of_block.increments;
    first += of_block.count();
  }
  rows.X = X(order, Eigen::all);
  rows.Y = Y(order, Eigen::all);
}

}  // namespace

std::vector<Index> LaggedRows::columns(const LinearStructure& structure) const {
  std::vector<Index> chosen(static_cast<std::size_t>(structure.regressors()));
  const auto inputs_from = chosen.begin() + structure.dimension();
  std::iota(chosen.begin(), inputs_from, Index{0});
  std::iota(inputs_from, inputs_from + structure.acting_inputs(),
            ranges.state_lags.high * states + (structure.input_delay.latest() - ranges.input_delay.low) * inputs);
  if (structure.intercept) chosen.back() = X.cols() - 1;
  return chosen;
}

StretchParts stretch_parts(const std::vector<Index>& run, Index runs, Index fewest_runs, Index fewest_parts) {
  StretchParts parts{run, runs, runs >= fewest_runs};
  if (parts.by_runs || runs == 0) return parts;
  const Index stretches = (fewest_parts + runs - 1) / runs;
  std::vector<Index> length(static_cast<std::size_t>(runs), 0), seen = length;
  for (const Index r : parts.part) ++length[static_cast<std::size_t>(r)];
  for (Index& part : parts.part) {
    const auto r = static_cast<std::size_t>(part);
    part = part * stretches + seen[r]++ * stretches / length[r];
  }
  parts.count = runs * stretches;
  return parts;
}

LaggedRows make_lagged_rows(const Recording& recording, const StructureRanges& ranges, bool intercept) {
  const LinearStructure widest = widest_of(recording, ranges, intercept);
  LaggedRows rows;
  rows.states = widest.states;
  rows.inputs = widest.inputs;
  rows.ranges = ranges;
  rows.intercept = intercept;
  const GatheredRows gathered = gather(recording, widest);
  rows.share = gathered.share;
  rows.parts = stretch_parts(runs_of(gathered), gathered.runs);
  const std::vector<Index> part = rows.parts.part;
  const Index folds = std::max(Index{1}, std::min(folds_of_parts, rows.parts.count));
  const auto fold = [&](Index row) { return part[static_cast<std::size_t>(row)] % folds; };
  std::vector<Index> order(part.size());
  std::iota(order.begin(), order.end(), Index{0});
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return fold(a) < fold(b); });
  put_rows(gathered, order, widest.regressors(), rows);
  for (std::size_t i = 0; i < order.size(); ++i) rows.parts.part[i] = part[static_cast<std::size_t>(order[i])];
  for (Index f = 0; f <= folds; ++f)
    rows.fold_begin.push_back(
        std::partition_point(order.begin(), order.end(), [&](Index row) { return fold(row) < f; }) - order.begin());
  transform(rows);
  return rows;
}

}  // namespace modebank
