#pragma once

#include <Eigen/Core>
#include <optional>

#include "filter/learn/likelihood/coordinates.hpp"
#include "filter/learn/likelihood/training_likelihood.hpp"
#include "filter/learn/switching/switching_regression.hpp"
#include "ident/data/trajectory.hpp"
#include "modebank/filter/options.hpp"

namespace modebank {

/// Step of central differences. Coordinates are in units of about their standard error, or are logarithms. The relative
/// error of a difference is about 1e-4.
inline constexpr double difference_step = 1e-2;

/// Derivatives of the log predictive densities of single training samples with respect to a bank's coordinates, at the
/// origin.
struct SampleGradients {
  Eigen::VectorXd sum;          ///< gradient of the training runs' log-likelihood [nats per coordinate]
  Eigen::MatrixXd information;  ///< sum of the outer products of the samples' gradients: Berndt, Hall, Hall & Hausman
                                ///< (1974, Annals of Economic and Social Measurement 3(4)), the observed information if
                                ///< the model is true
};

/// Gradients by central differences with `steps` (one per coordinate) in the bank's filter. `look`: score of look-ahead
/// learning.
SampleGradients sample_gradients(const BankCoordinates& around, const Eigen::VectorXd& steps,
                                 const Recording& recording, const FilterOptions& filter, const LookAhead& look = {});

/// The samples that an information is summed over. Long training runs are reduced to stretches of all runs, the same
/// for equal runs; the sums are multiplied by `factor`.
struct InformationSamples {
  std::optional<Recording> part;  ///< empty: all
  double factor = 1.0;

  /// `most`: largest number of transitions.
  InformationSamples(const Recording& recording, Index most);
};

/// Gradients by the switching regression. They require exactly measured states (R = 0). The densities equal those of
/// the filter, but cost far less, especially with many lags.
SampleGradients exact_sample_gradients(const BankCoordinates& around, const Eigen::VectorXd& steps,
                                       const TrainingTransitions& transitions);

/// Information of the prior about the coordinates, at the origin. It is exact for theta and the logit's memory. For Q
/// the prior counts as observations of a normal scatter, for T as counts. If all modes share one theta, the prior on
/// theta counts once.
Eigen::MatrixXd prior_information(const BankCoordinates& around, const SwitchingPrior& prior);

}  // namespace modebank
