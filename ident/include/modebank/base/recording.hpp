#pragma once

#include <string>
#include <vector>

#include "modebank/base/matrix.hpp"

namespace modebank {

/// One recorded run of N samples; column k of a signal is sample k.
struct RecordedRun {
  std::string name;            ///< name of the run
  bool held_out = false;       ///< true: the run is held out, so it is scored but not used for learning
  std::vector<double> time_s;  ///< N sample times, strictly increasing
  Matrix state;                ///< n x N, measured state; missing values are NaN
  Matrix input;                ///< m x N
};

/// All runs of one study object. Each run has the same n states and m inputs.
struct RecordedRuns {
  std::vector<RecordedRun> runs;         ///< the runs; at least one
  std::vector<std::string> state_names;  ///< n; if empty, the names are "x1", "x2", ...
  std::vector<std::string> input_names;  ///< m; if empty, the names are "u1", "u2", ...
};

}  // namespace modebank
