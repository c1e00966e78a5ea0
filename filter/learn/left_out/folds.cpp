#include "filter/learn/left_out/folds.hpp"

#include <algorithm>
#include <numeric>
#include <random>
#include <string>

#include "ident/base/seed.hpp"
#include "ident/data/stretch.hpp"

namespace modebank {
namespace {

std::vector<Trajectory> training_stretches_of(const Recording& recording, Index pieces) {
  std::vector<Trajectory> runs;
  for (const Trajectory& run : recording.runs)
    if (run.role == Role::train && run.transitions() > 0) runs.push_back(run);
  if (std::ssize(runs) >= refine_tuning.fewest_whole_runs) return runs;
  std::vector<Trajectory> parts;
  for (const Trajectory& run : runs) {
    const Index count = std::clamp(run.samples() / refine_tuning.shortest_stretch, Index{1}, pieces);
    for (Index i = 0; i < count; ++i) {
      const Index first = run.samples() * i / count;
      parts.push_back(stretch(run, first, run.samples() * (i + 1) / count - first));
      parts.back().run += "[" + std::to_string(first) + "]";
    }
  }
  return parts;
}

constexpr Index stretches = 100;         // smallest number of stretches in long runs; folds and random starts draw from
                                         // these stretches
constexpr Index shortest_stretch = 100;  // transitions; long enough for several stays in a mode and the filter's first
                                         // steps

struct Piece {
  const Trajectory* run;
  Index first, transitions;
};

/// All training runs in pieces of at most `longest` transitions, in the order of runs and time.
std::vector<Piece> pieces_of(const Recording& recording, Index longest) {
  std::vector<Piece> pieces;
  for (const Trajectory& run : recording.runs) {
    if (run.role != Role::train) continue;
    const Index all = run.transitions(), count = (all + longest - 1) / longest;
    for (Index i = 0; i < count; ++i) {
      const Index first = all * i / count;
      pieces.push_back({&run, first, all * (i + 1) / count - first});
    }
  }
  return pieces;
}

/// Appends a piece; merges it with the previous one if they are adjacent.
void append(std::vector<Piece>& drawn, const Piece& piece) {
  const bool goes_on =
      !drawn.empty() && drawn.back().run == piece.run && drawn.back().first + drawn.back().transitions == piece.first;
  if (goes_on)
    drawn.back().transitions += piece.transitions;
  else
    drawn.push_back(piece);
}

/// Index of the part with which each run is left out. The longest runs are assigned first, each to the part that is
/// shortest so far.
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

}  // namespace

std::vector<ValidationSplit> validation_splits(const Recording& recording, Index most) {
  const std::vector<Trajectory> runs = training_stretches_of(recording, most);
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

std::optional<Recording> learning_part(const Recording& recording, Index most, std::uint64_t seed) {
  const Index all = recording.transitions(Role::train);
  if (most == 0 || all <= most) return {};
  const std::vector<Piece> pieces = pieces_of(recording, std::max(shortest_stretch, most / stretches));
  const double share = static_cast<double>(most) / static_cast<double>(all);
  const Index count = std::max(Index{1}, static_cast<Index>(share * static_cast<double>(pieces.size())));
  std::vector<Piece> drawn;
  Index left = most;
  std::mt19937_64 generator = make_generator(seed, "learning part");
  for (const Index position : one_of_each_share(std::ssize(pieces), count, generator)) {
    Piece piece = pieces[static_cast<std::size_t>(position)];
    piece.transitions = std::min(piece.transitions, left);
    if (piece.transitions > 0) append(drawn, piece);
    left -= piece.transitions;
  }
  Recording part{recording.states, recording.inputs, {}, recording.quantum};
  for (const Piece& piece : drawn) {
    part.runs.push_back(stretch(*piece.run, piece.first, piece.transitions + 1));
    part.runs.back().run += "[" + std::to_string(piece.first) + "]";
  }
  return part;
}

}  // namespace modebank
