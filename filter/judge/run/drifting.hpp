#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/judge/run/horizon.hpp"
#include "filter/step/bank.hpp"
#include "filter/step/drifting_recursion.hpp"
#include "filter/step/feed/run_samples.hpp"
#include "filter/step/student_noise.hpp"
#include "ident/data/trajectory.hpp"

/// Predictions several steps ahead by banks with running noise (RunningNoise).
namespace modebank {

/// Predictions several samples ahead (DriftingForecast). Their variances do not yet have the factor of the horizon.
struct DriftingForecasts {
  HorizonEvaluation predictions;  ///< predictions; their log densities have a variance factor of 1

  /// Per horizon J n x N: errors whitened to unit variance and no correlation in each noise level, L^-1 error with
  /// L L' = cov(error). And J x N: log of the level's probability divided by the determinant of L.
  std::vector<Eigen::MatrixXd> whitened, log_weight;
};
DriftingForecasts drifting_forecasts(const Bank& bank, const Trajectory& run, std::vector<Eigen::Index> horizons);

/// Advances the recursion from the previous moment to moment t of a run. Returns the log density of the sample; NaN
/// without a prediction or a sample.
double follow(const RunInstants& instants, Eigen::Index t, const Trajectory& run, DriftingRecursion& recursion);

/// Log density of a prediction error [nats]. Outputs are decorrelated in order; each then has Student's density.
double log_density(const StudentNoise& noise, const Eigen::VectorXd& error, const Eigen::MatrixXd& covariance);

/// Change of the log density of sample k at a horizon (its index) if the variance is multiplied by `factor`.
double widening_gain(const StudentNoise& noise, const DriftingForecasts& forecasts, std::size_t horizon, Eigen::Index k,
                     double factor);

/// evaluate_horizons for a bank with running noise. Log densities are Student's, or mixtures
/// of the noise levels, with the bank's factor of the horizon. One sample ahead they are those of the filter.
/// Outputs with correlated errors are first decorrelated in order.
HorizonEvaluation drifting_horizons(const Bank& bank, const Trajectory& run, std::vector<Eigen::Index> horizons);

}  // namespace modebank
