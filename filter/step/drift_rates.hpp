#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "modebank/filter/wandering.hpp"

namespace modebank {

/// How coefficients of scaled regressors wander, in units of the noise variance v (method: section 6).
struct DriftRates {
  double q = 0.0;     ///< variance that a step adds to every coefficient; 0: they are constant
  double p0 = 0.0;    ///< variance of every coefficient at the start; with q = 0 both fix the coefficients
  double leak = 1.0;  ///< what a step leaves of their difference from theta0, in (0, 1]

  bool operator==(const DriftRates&) const = default;
};

/// How well settings that were chosen on a grid do on the training runs, and whether the grid was wide enough.
struct GridTuning {
  double log_score = 0.0;    ///< of the training runs [nats/sample]
  Eigen::Index samples = 0;  ///< scored there
  /// Settings whose best value is the grid's last while it could go on: of "q", "p0", "leak", "lam", "nu", "floor",
  /// "horizon_factor".
  std::vector<std::string> at_grid_end;
};

/// How the coefficients of a bank's modes wander in a run (equations/drift.hpp); each mode's Q is its v.
struct BankDrift {
  DriftRates rates = {};
  Eigen::VectorXd scale = {};            ///< r, root mean square of each regressor, positive; empty: nothing drifts
  Wandering wandering = Wandering::all;  ///< other than all only with running noise
  GridTuning tuning = {};                ///< of `drifting`

  bool empty() const { return scale.size() == 0; }
};

}  // namespace modebank
