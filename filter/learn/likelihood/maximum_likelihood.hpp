#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>

#include "filter/learn/likelihood/coordinates.hpp"
#include "filter/learn/switching/regression.hpp"
#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"
#include "modebank/filter/options.hpp"
#include "modebank/learn/results.hpp"

namespace modebank {

/// Largest number of state lags with which R is estimated. With more lags, lag coefficients can replace R. On ICE with
/// 17 lags the search took a minute for the bank and another for one_motion, without finding any R.
inline constexpr Eigen::Index most_lags_beside_R = 8;

/// The filter whose likelihood is maximised with measurement noise, whatever the variant of the bank's filter.
inline constexpr FilterOptions learning_filter{FilterVariant::imm};

/// Log-likelihood of all training runs [nats], each from its second sample. Runs in parallel, with a fixed order of
/// summation.
double training_log_likelihood(const Bank& bank, const Recording& recording, const FilterOptions& options);

/// The objective: the filter's log-likelihood of the training runs plus the prior's log density. The likelihood is
/// exact for one mode. For several modes it is the approximation of the IMM.
struct LikelihoodTarget {
  const Recording& recording;
  FilterOptions filter;                 ///< variant `imm` if there are several modes
  std::optional<SwitchingPrior> prior;  ///< if empty, the target is the likelihood without a prior
  bool one_theta = false;               ///< whether the prior on theta counts only once

  /// Value of the objective; minus infinity for a bank with non-finite numbers.
  double value(const Bank& bank) const;
  /// The prior's part; 0 without a prior.
  double log_prior(const Bank& bank) const;
};

struct AscentLimits {
  Index max_iterations = 100;
  double tolerance = 1e-6;  ///< nats per transition; the search has converged if the expected gain is at most this
  double least_value = -std::numeric_limits<double>::infinity();  ///< no search if a Newton step from the start is not
                                                                  ///< expected to rise above this value
};

struct LikelihoodMaximum {
  Bank bank;
  double value = 0.0;  ///< value of the target at the result; never below the value at the start
  Index iterations = 0;
  MeasuredFit end = MeasuredFit::stalled;  ///< none: no search, because of least_value
  bool rose = false;                       ///< true if the search converged at the start or moved to a better point
};

/// Finds the target's maximum near `start`, by BFGS (ceres::GradientProblemSolver) over BankCoordinates in units of the
/// standard errors. In these units all directions of the problem curve about equally. The gradient is computed by the
/// adjoint of the filter's steps (likelihood_gradient.hpp), or else by central differences. The information is computed
/// from the gradients of single samples (standard_errors.hpp). Converged: a Newton step is expected to gain less than
/// the tolerance per transition, and less than 1e-3 nats over all samples. A gain of 1e-3 nats corresponds to a step of
/// about a twentieth of a standard error.
LikelihoodMaximum maximise_likelihood(const LikelihoodTarget& target, const FreeParameters& free, const Bank& start,
                                      const AscentLimits& limits);

}  // namespace modebank
