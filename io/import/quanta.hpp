#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "ident/data/trajectory.hpp"
#include "io/import/options.hpp"
#include "io/import/run_streams.hpp"

namespace modebank {

/// Whether a run's states were interpolated between samples by join_run. False if they were taken from samples.
bool is_interpolated(const Stream& states, const Trajectory& joined);

/// Finds the rounding steps of states.
class Quanta {
 public:
  explicit Quanta(const DataOptions& options) : options_(options) {}

  /// Call it while the streams exist. `joined`: the run that was made from the streams.
  void look_at(const RunStreams& run, const Trajectory& joined);

  /// data.quantum of each state, as in Recording::quantum. Adds the decision to `notes`. Throws ConfigurationError for
  /// a wrong number of values.
  /// With `auto` it is the step that check_channel finds in the training runs. A step below a third of the standard
  /// deviation of the residuals about one linear model is ignored, because such a step does not affect a filter. States
  /// that were interpolated in any run get no step.
  Eigen::VectorXd decide(const Recording& recording, std::vector<std::string>& notes) const;

 private:
  const DataOptions& options_;
  bool interpolated_ = false;  ///< true if any run was interpolated
  bool rounded_ = false;       ///< true if samples of any interpolated run are rounded
};

}  // namespace modebank
