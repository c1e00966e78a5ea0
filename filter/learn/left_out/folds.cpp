#include "filter/learn/left_out/folds.hpp"

#include <algorithm>
#include <functional>
#include <numeric>
#include <random>
#include <string>

#include "ident/base/seed.hpp"
#include "ident/data/stretch.hpp"

namespace modebank {
namespace {

Trajectory named_stretch(const Trajectory& run, Index first, Index samples) {
  Trajectory part = stretch(run, first, samples);
  part.run += "[" + std::to_string(first) + "]";
  return part;
}

/// The training runs, or `pieces` stretches of each if there are few runs.
std::vector<Trajectory> runs_to_leave_out(const Recording& recording, Index pieces) {
  constexpr Index shortest = 20;  // samples; in shorter stretches the filter would mostly be starting
  std::vector<Trajectory> runs, parts;
  for (const Trajectory& run : recording.runs)
    if (run.role == Role::train && run.transitions() > 0) runs.push_back(run);
  if (std::ssize(runs) >= fewest_whole_runs) return runs;
  for (const Trajectory& run : runs) {
    const Index count = std::clamp(run.samples() / shortest, Index{1}, pieces);
    for (Index i = 0; i < count; ++i) {
      const Index first = run.samples() * i / count;
      parts.push_back(named_stretch(run, first, run.samples() * (i + 1) / count - first));
    }
  }
  return parts;
}

struct Piece {
  const Trajectory* run;
  Index first, transitions;
};

}  // namespace

std::vector<ValidationSplit> validation_splits(const Recording& recording, Index most) {
  const std::vector<Trajectory> runs = runs_to_leave_out(recording, most);
  if (runs.size() < 2 || most < 2) return {};
  const Index parts = std::min(most, std::ssize(runs));
  // The longest runs are assigned first, each to the part that is shortest so far.
  std::vector<std::size_t> order(runs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::greater(), [&](std::size_t i) { return runs[i].transitions(); });
  std::vector<Index> part(runs.size()), sum(static_cast<std::size_t>(parts), 0);
  for (const std::size_t i : order) {
    const auto shortest = std::ranges::min_element(sum);
    *shortest += runs[i].transitions();
    part[i] = shortest - sum.begin();
  }
  const Recording none{recording.states, recording.inputs, {}, recording.quantum};
  std::vector<ValidationSplit> splits(static_cast<std::size_t>(parts), {none, none});
  for (std::size_t i = 0; i < runs.size(); ++i)
    for (Index s = 0; s < parts; ++s) {
      ValidationSplit& split = splits[static_cast<std::size_t>(s)];
      (part[i] == s ? split.left_out : split.training).runs.push_back(runs[i]);
    }
  return splits;
}

std::optional<Recording> learning_part(const Recording& recording, Index most, std::uint64_t seed) {
  constexpr Index stretches = 100;  // at least in long runs; folds and random starts draw from them
  constexpr Index shortest = 100;   // transitions; long enough for several stays in a mode and the filter's first steps
  const Index all = recording.transitions(Role::train);
  if (most == 0 || all <= most) return {};
  const Index longest = std::max(shortest, most / stretches);
  std::vector<Piece> pieces;
  for (const Trajectory& run : recording.runs) {
    if (run.role != Role::train) continue;
    const Index count = (run.transitions() + longest - 1) / longest;
    for (Index i = 0; i < count; ++i) {
      const Index first = run.transitions() * i / count;
      pieces.push_back({&run, first, run.transitions() * (i + 1) / count - first});
    }
  }
  const double share = static_cast<double>(most) / static_cast<double>(all);
  const Index count = std::max(Index{1}, static_cast<Index>(share * static_cast<double>(pieces.size())));
  std::vector<Piece> drawn;
  Index left = most;
  std::mt19937_64 generator = make_generator(seed, "learning part");
  for (const Index position : one_of_each_share(std::ssize(pieces), count, generator)) {
    Piece piece = pieces[static_cast<std::size_t>(position)];
    piece.transitions = std::min(piece.transitions, left);
    left -= piece.transitions;
    Piece* before = drawn.empty() ? nullptr : &drawn.back();
    if (before && before->run == piece.run && before->first + before->transitions == piece.first)
      before->transitions += piece.transitions;
    else if (piece.transitions > 0)
      drawn.push_back(piece);
  }
  Recording part{recording.states, recording.inputs, {}, recording.quantum};
  for (const Piece& piece : drawn) part.runs.push_back(named_stretch(*piece.run, piece.first, piece.transitions + 1));
  return part;
}

}  // namespace modebank
