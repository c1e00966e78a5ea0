#include "filter/learn/refine/learning_part.hpp"

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "ident/base/seed.hpp"
#include "ident/data/stretch.hpp"

namespace modebank {
namespace {

using Eigen::Index;

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

}  // namespace

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
