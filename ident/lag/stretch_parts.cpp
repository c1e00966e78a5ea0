#include "ident/lag/stretch_parts.hpp"

#include <utility>

namespace modebank {

using Eigen::Index;

StretchParts stretch_parts(std::vector<Index> run, Index runs, Index fewest_runs, Index fewest_parts) {
  StretchParts parts{std::move(run), runs, runs >= fewest_runs};
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

}  // namespace modebank
