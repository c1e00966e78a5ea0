#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/judge/run/horizon.hpp"
#include "filter/step/bank.hpp"
#include "filter/step/drifting_recursion.hpp"
#include "filter/step/feed/run_samples.hpp"
#include "filter/step/student_noise.hpp"
#include "ident/data/trajectory.hpp"

/// Banks whose noise runs (RunningNoise), several steps ahead.
namespace modebank {

/// Predictions some samples ahead (DriftingForecast), before the factor of their horizon has widened them.
struct DriftingForecasts {
  HorizonEvaluation predictions;  ///< its log densities are those of factor 1
  /// Per horizon n x N: errors of variance one and uncorrelated, L^-1 error with L L' = cov(error).
  std::vector<Eigen::MatrixXd> whitened;
};
DriftingForecasts drifting_forecasts(const Bank& bank, const Trajectory& run, std::vector<Eigen::Index> horizons);

/// Takes the recursion from the moment before to moment t of a run.
void follow(const RunInstants& instants, Eigen::Index t, const Trajectory& run, DriftingRecursion& recursion);

/// Log density of the error of a prediction: outputs decorrelated in their order, then each Student's [nats].
double log_density(const StudentNoise& noise, const Eigen::VectorXd& error, const Eigen::MatrixXd& covariance);

/// By how much the log density of whitened errors changes when their variance is multiplied by `factor`.
double widening_gain(const StudentNoise& noise, const Eigen::Ref<const Eigen::VectorXd>& whitened, double factor);

/// evaluate_horizons of such a bank. Log densities: Student's, times the bank's factor of the horizon; outputs whose
/// errors are correlated are decorrelated in their order first.
HorizonEvaluation drifting_horizons(const Bank& bank, const Trajectory& run, std::vector<Eigen::Index> horizons);

}  // namespace modebank
