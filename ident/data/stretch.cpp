#include "ident/data/stretch.hpp"

namespace modebank {

Trajectory stretch(const Trajectory& run, Eigen::Index first, Eigen::Index count) {
  Trajectory part;
  part.run = run.run;
  part.role = run.role;
  part.lag_s = run.lag_s;
  part.time_origin_ns = run.time_origin_ns;
  part.file = run.file;
  part.time_s = run.time_s.segment(first, count);
  part.state = run.state.middleCols(first, count);
  part.input = run.input.middleCols(first, count);
  if (run.truth.size() > 0) part.truth = run.truth.middleCols(first, count);
  return part;
}

Recording from_common_start(const Recording& recording, Eigen::Index earlier) {
  Recording part{recording.states, recording.inputs, {}, recording.quantum};
  for (const Trajectory& run : recording.runs)
    if (run.role == Role::train && run.samples() > earlier + 2)
      part.runs.push_back(stretch(run, earlier, run.samples() - earlier));
  return part;
}

}  // namespace modebank
