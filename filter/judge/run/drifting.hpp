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

  /// Per horizon n x N: errors whitened to unit variance and no correlation, L^-1 error with L L' = cov(error).
  std::vector<Eigen::MatrixXd> whitened;
};
DriftingForecasts drifting_forecasts(const Bank& bank, const Trajectory& run, std::vector<Eigen::Index> horizons);

/// Advances the recursion from the previous moment to moment t of a run.
void follow(const RunInstants& instants, Eigen::Index t, const Trajectory& run, DriftingRecursion& recursion);

/// Log density of a prediction error [nats]. Outputs are decorrelated in order; each then has Student's density.
double log_density(const StudentNoise& noise, const Eigen::VectorXd& error, const Eigen::MatrixXd& covariance);

/// Change of the log density of whitened errors if their variance is multiplied by `factor`.
double widening_gain(const StudentNoise& noise, const Eigen::Ref<const Eigen::VectorXd>& whitened, double factor);

/// evaluate_horizons for a bank with running noise. Log densities are Student's, with the bank's factor of the horizon.
/// Outputs with correlated errors are first decorrelated in order.
HorizonEvaluation drifting_horizons(const Bank& bank, const Trajectory& run, std::vector<Eigen::Index> horizons);

}  // namespace modebank
