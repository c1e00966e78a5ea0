#include "ident/window_plan.hpp"

#include <algorithm>
#include <string>

#include "ident/error.hpp"

namespace modebank {

WindowPlan::WindowPlan(const Recording& recording, Index length, Index step, Index first) : step_(step) {
  for (std::size_t r = 0; r < recording.runs.size(); ++r) {
    const Trajectory& run = recording.runs[r];
    const Index last = run.transitions() - length;  // start of the last window
    if (run.role != Role::train || last < first) continue;
    runs_.push_back({count_, (last - first) / step + 1, {static_cast<Index>(r), first}});
    count_ += runs_.back().count;
  }
}

Window WindowPlan::window(Index i) const {
  const auto after = [](Index index, const Stretch& run) { return index < run.first; };
  const Stretch& run = *(std::upper_bound(runs_.begin(), runs_.end(), i, after) - 1);
  return {run.window.run, run.window.start + (i - run.first) * step_};
}

std::vector<WindowPlan::Stretch> WindowPlan::stretches(Index first, Index count, Index longest) const {
  std::vector<Stretch> result;
  for (const Stretch& run : runs_) {
    const Index end = std::min(first + count, run.first + run.count);
    for (Index i = std::max(first, run.first); i < end; i += longest)
      result.push_back({i, std::min(longest, end - i), window(i)});
  }
  return result;
}

WindowFits empty_fits(const FitOptions& options, const LinearStructure& structure, Index windows) {
  if (windows == 0)
    throw DataError("no training run has the " + std::to_string(options.length) + " transitions of a window");
  WindowFits fits;
  fits.model = options.model;
  fits.structure = structure;
  fits.residual = options.residual;
  fits.length = options.length;
  fits.step = options.step;
  fits.loss = options.loss;
  return fits;
}

}  // namespace modebank
