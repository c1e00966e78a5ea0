#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "ident/data/trajectory.hpp"
#include "io/import/options.hpp"
#include "io/import/run_streams.hpp"

namespace modebank {

/// Whether a run's states were interpolated between samples (join_run does this), and not taken from samples.
bool is_interpolated(const Stream& states, const Trajectory& joined);

/// Finds the rounding steps of states.
class Quanta {
 public:
  explicit Quanta(const DataOptions& options) : options_(options) {}

  /// Call it while the streams exist. `joined`: the run made of them.
  void look_at(const RunStreams& run, const Trajectory& joined);

  /// data.quantum by state, as in Recording::quantum. With `auto` it is the step that check_channel finds in the
  /// training runs, if this step is at least a third of the standard deviation of their residuals about one linear
  /// model. Finer steps do not affect a filter. States that were interpolated in any run get no step. Adds the decision
  /// to `notes`. Throws ConfigurationError for a wrong number of values.
  Eigen::VectorXd decide(const Recording& recording, std::vector<std::string>& notes) const;

 private:
  const DataOptions& options_;
  bool interpolated_ = false;  ///< for any run
  bool rounded_ = false;       ///< for samples of any interpolated run
};

}  // namespace modebank
