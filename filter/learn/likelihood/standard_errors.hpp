#pragma once

#include <Eigen/Core>
#include <optional>

#include "filter/learn/likelihood/maximum_likelihood.hpp"
#include "filter/learn/switching/regression.hpp"
#include "filter/step/bank.hpp"

namespace modebank {

/// Derivatives of the log predictive densities of single training samples with respect to a bank's coordinates, at the
/// origin.
struct SampleGradients {
  Eigen::VectorXd sum;          ///< gradient of the training runs' log-likelihood [nats per coordinate]
  Eigen::MatrixXd information;  ///< sum of the outer products of the samples' gradients: Berndt, Hall, Hall & Hausman
                                ///< (1974, Annals of Economic and Social Measurement 3(4)), the observed information if
                                ///< the model is true
};

/// Gradients by central differences with `steps` (one per coordinate) in the bank's filter.
SampleGradients sample_gradients(const BankCoordinates& around, const Eigen::VectorXd& steps,
                                 const Recording& recording, const FilterOptions& filter);

/// The samples that an information is summed over. Long training runs are reduced to stretches of all runs, the same
/// for equal runs; the sums are multiplied by `factor`.
struct InformationSamples {
  std::optional<Recording> part;  ///< empty: all
  double factor = 1.0;

  /// `most`: largest number of transitions.
  InformationSamples(const Recording& recording, Index most);
};

/// Information of the prior about the coordinates, at the origin. It is exact for theta. For Q the prior counts as
/// observations of a normal scatter, for T as counts. If all modes share one theta, the prior on theta counts once.
Eigen::MatrixXd prior_information(const BankCoordinates& around, const SwitchingPrior& prior);

/// All parameters of a bank as free parameters, with theta in units of its standard errors given the smoothed modes.
/// `complete`: expected sums of a fit. `estimate_R`: includes R of all outputs, at least `least_R` (n_y). The weights
/// of a logit are known.
FreeParameters all_parameters(const Bank& bank, const SwitchingSums& complete, const SwitchingPrior& prior,
                              bool one_theta, bool estimate_R, const Eigen::VectorXd& least_R);

/// The bank with standard errors of its free parameters among theta, Q, T and R. The covariance of theta becomes the
/// parameter covariance of the modes. The errors come from the inverse of the observed information (SampleGradients)
/// plus the information of the prior. The inverse is for all parameters together, in the target's filter. So the errors
/// include the uncertainty of the modes and, for R > 0, of the states. The fit's expected sums (Louis 1982's complete
/// information) do not include this uncertainty. The model is assumed true. Long recordings are reduced to stretches of
/// all training runs (left_out/folds.hpp), and the information is scaled up. If the information is singular, the errors
/// come from the complete information, and those of R are NaN.
///
/// Requires target.prior; `free` is all_parameters of the same bank.
Bank with_standard_errors(const LikelihoodTarget& target, const FreeParameters& free, const SwitchingSums& complete,
                          Bank bank);

}  // namespace modebank
