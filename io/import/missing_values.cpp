#include "io/import/missing_values.hpp"

#include <fmt/format.h>

#include "ident/data/streams.hpp"
#include "ident/data/stretch.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

bool known(const Trajectory& run, Index k) { return run.state.col(k).allFinite() && run.input.col(k).allFinite(); }

[[noreturn]] void fail(const Trajectory& run) {
  throw DataError(fmt::format("run \"{}\" has no two samples in a row without a gap or missing value", run.run));
}

}  // namespace

std::vector<Trajectory> split_at_gaps(const Trajectory& run, bool predict, const std::vector<bool>& kept) {
  const auto usable = [&](Index k) {
    // The last entry of `kept` belongs to the run's last sample, but the run's first samples may have been dropped.
    const std::size_t dropped = kept.empty() ? 0 : kept.size() - static_cast<std::size_t>(run.samples());
    return (kept.empty() || kept[dropped + static_cast<std::size_t>(k)]) && (predict || known(run, k));
  };
  const double longest = gap_periods * median_period_s(run.time_s);
  std::vector<Trajectory> parts;
  for (Index first = 0; first < run.samples();) {
    if (!usable(first)) {
      ++first;
      continue;
    }
    Index end = first + 1;
    while (end < run.samples() && usable(end) && run.time_s(end) - run.time_s(end - 1) <= longest) ++end;
    if (end - first >= 2) parts.push_back(stretch(run, first, end - first));
    first = end;
  }
  if (parts.empty()) fail(run);
  if (parts.size() > 1 || parts[0].samples() < run.samples())
    for (std::size_t i = 0; i < parts.size(); ++i) parts[i].run = fmt::format("{}.{}", run.run, i + 1);
  return parts;
}

Trajectory hold_missing_inputs(const Trajectory& run) {
  Index first = 0;
  while (first < run.samples() && !run.input.col(first).allFinite()) ++first;
  if (run.samples() - first < 2) fail(run);
  Trajectory held = stretch(run, first, run.samples() - first);
  for (Index k = 1; k < held.samples(); ++k)
    held.input.col(k) = held.input.col(k).array().isFinite().select(held.input.col(k), held.input.col(k - 1));
  return held;
}

}  // namespace modebank
