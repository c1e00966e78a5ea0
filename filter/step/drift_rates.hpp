#pragma once

#include <Eigen/Core>

namespace modebank {

/// How coefficients of scaled regressors wander, in units of the noise variance v (method: section 6).
struct DriftRates {
  double q = 0.0;     ///< variance that a step adds to every coefficient; 0: they are constant
  double p0 = 0.0;    ///< variance of every coefficient at the start; with q = 0 both fix the coefficients
  double leak = 1.0;  ///< what a step leaves of their difference from theta0, in (0, 1]

  bool operator==(const DriftRates&) const = default;
};

/// How the coefficients of a bank's modes wander in a run (equations/drift.hpp); each mode's Q is its v.
struct BankDrift {
  DriftRates rates = {};
  Eigen::VectorXd scale = {};  ///< r, root mean square of each regressor, positive; empty: nothing drifts

  bool empty() const { return scale.size() == 0; }
};

}  // namespace modebank
