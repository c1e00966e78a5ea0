#include "filter/learn/refine/folds.hpp"

#include <algorithm>
#include <numeric>
#include <string>

#include "ident/data/stretch.hpp"

namespace modebank {
namespace {

std::vector<Trajectory> training_stretches_of(const Recording& recording, Index pieces, const RefineTuning& tuning) {
  std::vector<Trajectory> runs;
  for (const Trajectory& run : recording.runs)
    if (run.role == Role::train && run.transitions() > 0) runs.push_back(run);
  if (std::ssize(runs) >= tuning.fewest_whole_runs) return runs;
  std::vector<Trajectory> parts;
  for (const Trajectory& run : runs) {
    const Index count = std::clamp(run.samples() / tuning.shortest_stretch, Index{1}, pieces);
    for (Index i = 0; i < count; ++i) {
      const Index first = run.samples() * i / count;
      parts.push_back(stretch(run, first, run.samples() * (i + 1) / count - first));
      parts.back().run += "[" + std::to_string(first) + "]";
    }
  }
  return parts;
}

/// Which part each run is left out with: the longest first, each to the part that is shortest so far.
std::vector<Index> part_of_runs(const std::vector<Trajectory>& runs, Index parts) {
  std::vector<Index> order(runs.size()), part(runs.size());
  std::iota(order.begin(), order.end(), Index{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](Index a, Index b) { return runs[a].transitions() > runs[b].transitions(); });
  std::vector<Index> length(parts, 0);
  for (const Index i : order) {
    part[i] = std::min_element(length.begin(), length.end()) - length.begin();
    length[part[i]] += runs[i].transitions();
  }
  return part;
}

}  // namespace

std::vector<ValidationSplit> validation_splits(const Recording& recording, Index most, const RefineTuning& tuning) {
  const std::vector<Trajectory> runs = training_stretches_of(recording, most, tuning);
  if (runs.size() < 2 || most < 2) return {};
  const Index parts = std::min(most, std::ssize(runs));
  const std::vector<Index> part = part_of_runs(runs, parts);
  std::vector<ValidationSplit> splits(parts);
  for (Index s = 0; s < parts; ++s) {
    splits[s].training = {recording.states, recording.inputs, {}};
    splits[s].left_out = splits[s].training;
    for (std::size_t i = 0; i < runs.size(); ++i)
      (part[i] == s ? splits[s].left_out : splits[s].training).runs.push_back(runs[i]);
  }
  return splits;
}

}  // namespace modebank
