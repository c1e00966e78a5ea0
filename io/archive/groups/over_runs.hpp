#pragma once

#include <vector>

#include "io/archive/groups/sample_reader.hpp"
#include "io/archive/groups/sample_writer.hpp"

namespace modebank {

/// Reads or writes arrays of a group over the samples of all runs, one run after another. `runs`: rows of each run.
/// `body(samples, i)` reads or writes the arrays of run i.
template <class Io, class Body>
void over_runs(Io& io, const std::vector<hdf5::Rows>& runs, Body body) {
  const hsize_t total = runs.empty() ? 0 : runs.back().end();
  std::conditional_t<Io::reads, SampleReader, SampleWriter> samples(io, total);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    samples.begin_run(runs[i]);
    body(samples, i);
  }
  if constexpr (!Io::reads) samples.finish();
}

}  // namespace modebank
