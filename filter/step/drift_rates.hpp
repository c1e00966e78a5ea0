#pragma once

#include <Eigen/Core>
#include <vector>

#include "modebank/filter/wandering.hpp"

namespace modebank {

/// Drift of the coefficients of scaled regressors, in units of the noise variance v (method: section 6).
struct DriftRates {
  double q = 0.0;     ///< variance added to every coefficient per step; 0 for constant coefficients
  double p0 = 0.0;    ///< variance of every coefficient at the start; if q and p0 are 0, coefficients are fixed
  double leak = 1.0;  ///< factor per step on the difference from theta0, in (0, 1]

  bool operator==(const DriftRates&) const = default;
};

/// Log score of the settings that were chosen on a grid, on the training runs.
struct GridTuning {
  double log_score = 0.0;    ///< log score of the training runs [nats/sample]
  Eigen::Index samples = 0;  ///< number of scored training samples
};

/// Drift of the coefficients of the competitor `drifting` within a run (DriftingRecursion).
struct BankDrift {
  DriftRates rates = {};
  Eigen::VectorXd scale = {};            ///< r, root mean square of each regressor, positive; empty without drift
  Wandering wandering = Wandering::all;  ///< which coefficients drift
  GridTuning tuning = {};                ///< how the competitor `drifting` was tuned

  bool empty() const { return scale.size() == 0; }
};

/// Estimates of a mode that drifts, with J noise levels (running_noise.hpp).
struct DriftState {
  Eigen::MatrixXd theta = {};           ///< (r n) x J, coefficients of scaled regressors
  std::vector<Eigen::MatrixXd> P = {};  ///< J n matrices r x r (lower triangles), output by output within a level;
                                        ///< divided by the output's variance
  Eigen::VectorXd variance = {};        ///< n, running noise variance v
  Eigen::VectorXd level = {};           ///< J, probabilities of the levels
};

}  // namespace modebank
