#include "ident/data/window.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace modebank {

WindowPlan::WindowPlan(const Recording& recording, Index length, Index step, Index first) : step_(step) {
  if (length < 1) throw std::invalid_argument("window length " + std::to_string(length) + " is below 1");
  if (step < 1) throw std::invalid_argument("window step " + std::to_string(step) + " is below 1");
  for (std::size_t r = 0; r < recording.runs.size(); ++r) {
    const Trajectory& run = recording.runs[r];
    const Index last = run.transitions() - length;  // start of the last window
    if (run.role != Role::train || last < first) continue;
    runs_.push_back({count_, (last - first) / step + 1, {static_cast<Index>(r), first}});
    count_ += runs_.back().count;
  }
}

Window WindowPlan::window(Index i) const {
  const auto after = [](Index index, const Range& run) { return index < run.first; };
  const Range& run = *(std::upper_bound(runs_.begin(), runs_.end(), i, after) - 1);
  return {run.window.run, run.window.start + (i - run.first) * step_};
}

std::vector<WindowPlan::Range> WindowPlan::ranges(Index first, Index count, Index longest) const {
  std::vector<Range> result;
  for (const Range& run : runs_) {
    const Index end = std::min(first + count, run.first + run.count);
    for (Index i = std::max(first, run.first); i < end; i += longest)
      result.push_back({i, std::min(longest, end - i), window(i)});
  }
  return result;
}

}  // namespace modebank
