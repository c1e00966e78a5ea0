#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "ident/data/trajectory.hpp"
#include "io/import/options.hpp"
#include "io/import/run_streams.hpp"

namespace modebank {

/// Whether a run's states are values between its samples (join_run interpolates), not samples themselves.
bool is_interpolated(const Stream& states, const Trajectory& joined);

/// What states are multiples of.
class Quanta {
 public:
  explicit Quanta(const DataOptions& options) : options_(options) {}

  /// Before its streams are let go. `joined`: what they became.
  void look_at(const RunStreams& run, const Trajectory& joined);

  /// data.quantum by state, as Recording::quantum. With auto what check_channel finds in the training runs, where that
  /// is at least a third of the standard deviation of their residuals about one linear model: a finer one changes
  /// nothing that a filter could tell. States that were interpolated in any run are of no quantum. What was decided is
  /// told in `notes`. Throws ConfigurationError for a number of quanta that fits no states.
  Eigen::VectorXd decide(const Recording& recording, std::vector<std::string>& notes) const;

 private:
  const DataOptions& options_;
  bool interpolated_ = false;  ///< any run
  bool rounded_ = false;       ///< any interpolated run's samples
};

}  // namespace modebank
