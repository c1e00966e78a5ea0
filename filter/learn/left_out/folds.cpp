#include "filter/learn/left_out/folds.hpp"

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

}  // namespace

std::vector<Index> deal_by_length(const std::vector<Index>& lengths, Index parts) {
  std::vector<Index> order(lengths.size()), part(lengths.size());
  std::iota(order.begin(), order.end(), Index{0});
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return lengths[a] > lengths[b]; });
  std::vector<Index> sum(parts, 0);
  for (const Index i : order) {
    part[i] = std::min_element(sum.begin(), sum.end()) - sum.begin();
    sum[part[i]] += lengths[i];
  }
  return part;
}

std::vector<ValidationSplit> validation_splits(const Recording& recording, Index most, const RefineTuning& tuning) {
  const std::vector<Trajectory> runs = training_stretches_of(recording, most, tuning);
  if (runs.size() < 2 || most < 2) return {};
  const Index parts = std::min(most, std::ssize(runs));
  std::vector<Index> lengths;
  for (const Trajectory& run : runs) lengths.push_back(run.transitions());
  const std::vector<Index> part = deal_by_length(lengths, parts);
  std::vector<ValidationSplit> splits(parts);
  for (Index s = 0; s < parts; ++s) {
    splits[s].training = {recording.states, recording.inputs, {}, recording.quantum};
    splits[s].left_out = splits[s].training;
    for (std::size_t i = 0; i < runs.size(); ++i)
      (part[i] == s ? splits[s].left_out : splits[s].training).runs.push_back(runs[i]);
  }
  return splits;
}

}  // namespace modebank
