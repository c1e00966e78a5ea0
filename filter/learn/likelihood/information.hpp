#pragma once

#include <Eigen/Core>

#include "filter/judge/run/look_ahead.hpp"
#include "filter/learn/likelihood/coordinates.hpp"
#include "filter/learn/switching/switching_regression.hpp"
#include "ident/data/trajectory.hpp"
#include "modebank/filter/options.hpp"

namespace modebank {

/// Of coordinates that are in units of about their standard error, or logarithms: central differences by so much are
/// off by a ten thousandth.
inline constexpr double difference_step = 1e-2;

/// Derivatives of the log predictive densities of single training samples by a bank's coordinates, at their origin.
struct SampleGradients {
  Eigen::VectorXd sum;          ///< gradient of the training runs' log-likelihood [nats per coordinate]
  Eigen::MatrixXd information;  ///< sum of their outer products: Berndt, Hall, Hall & Hausman (1974, Annals of Economic
                                ///< and Social Measurement 3(4)), the observed information of a model that is true
};

/// By central differences of `steps` (one per coordinate) in the filter that will run the bank. A sample of weight w,
/// in units of their mean, counts as w samples. `look`: of what learning counts that looks ahead.
SampleGradients sample_gradients(const BankCoordinates& around, const Eigen::VectorXd& steps,
                                 const Recording& recording, const FilterOptions& filter, const LookAhead& look = {});

/// Gradients where states are measured exactly (R = 0) and samples have no weights: by the switching regression, whose
/// densities are the filter's at a fraction of the cost, the smaller the more lags there are.
SampleGradients exact_sample_gradients(const BankCoordinates& around, const Eigen::VectorXd& steps,
                                       const TrainingTransitions& transitions);

/// What the prior adds to the information about the coordinates, at their origin: of theta exactly, of Q as so many
/// observations of a normal scatter, of T as so many counts, of a guard's memory
/// exactly. A prior on one theta of all modes counts once.
Eigen::MatrixXd prior_information(const BankCoordinates& around, const SwitchingPrior& prior);

}  // namespace modebank
