#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "modebank/filter/wandering.hpp"

namespace modebank {

/// Drift of the coefficients of scaled regressors, in units of the noise variance v (method: section 6).
struct DriftRates {
  double q = 0.0;     ///< variance added to every coefficient per step; 0 for constant coefficients
  double p0 = 0.0;    ///< variance of every coefficient at the start; if q is 0, too, coefficients are fixed
  double leak = 1.0;  ///< factor per step on the difference from theta0, in (0, 1]

  bool operator==(const DriftRates&) const = default;
};

/// Score of the settings that were chosen on a grid, on the training runs, and whether the grid was wide enough.
struct GridTuning {
  double log_score = 0.0;    ///< log score of the training runs [nats/sample]
  Eigen::Index samples = 0;  ///< scored training samples

  /// Settings whose best value lies at the end of the grid, so that the optimum may lie beyond. From "q", "p0", "leak",
  /// "lam", "nu", "floor", "horizon_factor".
  std::vector<std::string> at_grid_end;
};

/// Drift of the coefficients of a bank's modes within a run (equations/drift.hpp); v is each mode's Q.
struct BankDrift {
  DriftRates rates = {};
  Eigen::VectorXd scale = {};            ///< r, root mean square of each regressor, positive; empty without drift
  Wandering wandering = Wandering::all;  ///< coefficients that drift; a value other than `all` requires running noise
  GridTuning tuning = {};                ///< tuning of the competitor `drifting`

  bool empty() const { return scale.size() == 0; }
};

}  // namespace modebank
