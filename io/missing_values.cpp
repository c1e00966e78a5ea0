#include "io/missing_values.hpp"

#include <fmt/format.h>

#include "ident/error.hpp"

namespace modebank {

namespace {

Trajectory stretch(const Trajectory& run, Index first, Index samples) {
  Trajectory part = run;
  part.time_s = run.time_s.segment(first, samples);
  part.state = run.state.middleCols(first, samples);
  part.input = run.input.middleCols(first, samples);
  if (run.truth.cols() > 0) part.truth = run.truth.middleCols(first, samples);
  return part;
}

bool known(const Trajectory& run, Index k) { return run.state.col(k).allFinite() && run.input.col(k).allFinite(); }

[[noreturn]] void fail(const Trajectory& run) {
  throw DataError(fmt::format("run \"{}\" has no two samples in a row without a missing value", run.run));
}

}  // namespace

std::vector<Trajectory> split_at_gaps(const Trajectory& run) {
  std::vector<Trajectory> parts;
  bool whole = true;
  for (Index first = 0; first < run.samples();) {
    Index end = first;
    while (end < run.samples() && known(run, end)) ++end;
    if (end - first >= 2) parts.push_back(stretch(run, first, end - first));
    whole = whole && end == run.samples();
    first = end + 1;
  }
  if (parts.empty()) fail(run);
  if (!whole)
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
