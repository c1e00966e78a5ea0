#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/judge/run/evaluate.hpp"
#include "filter/judge/run/horizon.hpp"
#include "filter/step/drifting.hpp"
#include "filter/step/feed/run_samples.hpp"
#include "filter/step/student_noise.hpp"
#include "ident/data/trajectory.hpp"

namespace modebank {

/// What DriftingFilter says of every sample of a run, under the conventions and conditions of evaluate_run of a bank.
RunEvaluation evaluate_run(const DriftingModel& model, const Trajectory& run);

/// Predictions some samples ahead (DriftingForecast), before the factor of their horizon has widened them.
struct DriftingForecasts {
  HorizonEvaluation predictions;  ///< its log densities are those of factor 1
  /// Per horizon n x N: errors of variance one and uncorrelated, L^-1 error with L L' = cov(error).
  std::vector<Eigen::MatrixXd> whitened;
};
DriftingForecasts forecast(const DriftingModel& model, const Trajectory& run, std::vector<Eigen::Index> horizons);

/// Takes the recursion from the moment before to moment t of a run; v follows where something was measured.
void follow(const DriftingModel& model, const RunInstants& instants, Eigen::Index t, const Trajectory& run,
            DriftingRecursion& recursion, Eigen::VectorXd& v);

/// Log density of the error of a prediction: outputs decorrelated in their order, then each Student's [nats].
double log_density(const StudentNoise& noise, const Eigen::VectorXd& error, const Eigen::MatrixXd& covariance);

/// By how much the log density of whitened errors changes when their variance is multiplied by `factor`.
double widening_gain(const StudentNoise& noise, const Eigen::Ref<const Eigen::VectorXd>& whitened, double factor);

/// The same conventions as those of banks. Log densities: Student's, times the model's factor of the horizon; outputs
/// whose errors are correlated are decorrelated in their order first.
HorizonEvaluation evaluate_horizons(const DriftingModel& model, const Trajectory& run,
                                    std::vector<Eigen::Index> horizons);

}  // namespace modebank
