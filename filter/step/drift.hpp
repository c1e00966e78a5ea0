#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <utility>
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

/// Drift of the coefficients of the competitor `drifting` within a run (DriftingFilter).
struct BankDrift {
  DriftRates rates = {};
  Eigen::VectorXd scale = {};            ///< r, root mean square of each regressor, positive; empty without drift
  Wandering wandering = Wandering::all;  ///< which coefficients drift
  GridTuning tuning = {};                ///< how the competitor `drifting` was tuned

  bool empty() const { return scale.size() == 0; }
};

/// Noise of one motion. The variance follows each output separately (method: section 6, `drifting`). e is a prediction
/// error with Student's t distribution of variance v (s + h'Ph). P is the covariance of the coefficients divided by v.
/// s is the noise level: 1, or one of J levels between which the noise switches by a Markov chain. At a start, v is the
/// diagonal of Q. Then, with the probabilities mu of the levels after the sample,
///   v <- max(lam v + (1 - lam) sum_j mu_j e_j^2 / (s_j + h'P_j h), floor).
/// Given the past and the level, outputs are independent.
struct RunningNoise {
  double lam = 0.9;            ///< forgetting factor of the running variance, in [0, 1]
  double nu = 0.0;             ///< degrees of freedom, above 2; 0 for a normal distribution
  Eigen::VectorXd floor = {};  ///< n, smallest value of v; if empty, the noise is Q and constant

  /// Horizons in samples, ascending from 2, and for each horizon the factor on the first-order variance. One sample
  /// ahead the factor is 1, because the prediction is that of the filter.
  std::vector<std::pair<Eigen::Index, double>> horizon_factor = {};

  Eigen::MatrixXd level = {};      ///< n x J, variance of each level in units of v; if empty, one level of 1
  Eigen::MatrixXd switching = {};  ///< J x J, row i: probabilities of the next level after level i

  bool empty() const { return floor.size() == 0; }
  Eigen::Index levels() const { return std::max<Eigen::Index>(level.cols(), 1); }
  /// The factor of the longest horizon that is not above this one; 1 if every horizon is above it.
  double factor_at(Eigen::Index horizon) const {
    double factor = 1.0;
    for (const auto& [ahead, value] : horizon_factor)
      if (ahead <= horizon) factor = value;
    return factor;
  }
};

}  // namespace modebank
