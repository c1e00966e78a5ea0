#pragma once

#include <Eigen/Core>
#include <optional>

#include "filter/judge/run/look_ahead.hpp"
#include "filter/learn/likelihood/coordinates.hpp"
#include "filter/learn/switching/switching_regression.hpp"
#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"
#include "modebank/filter/options.hpp"
#include "modebank/learn/results.hpp"

namespace modebank {

/// Coefficients of more lags than these predict what R would let a filter predict. On ICE with 17 the search took a
/// minute for the bank and another for one_motion, and found none.
inline constexpr Eigen::Index most_lags_beside_R = 8;

/// What is maximised: the filter's log-likelihood of the training runs plus the prior's log density; a sample's weight
/// is the power of its density. The likelihood is exact for one mode and the IMM's approximation for several.
struct LikelihoodTarget {
  const Recording& recording;
  FilterOptions filter;                 ///< variant imm for several modes
  std::optional<SwitchingPrior> prior;  ///< empty: the likelihood alone
  bool one_theta = false;               ///< the prior on theta counts once
  LookAhead look = {};                  ///< what is counted instead of the likelihood, if learning looks ahead

  /// Minus infinity of a bank that is not all numbers, which no filter can run.
  double value(const Bank& bank) const;
  /// Requires a prior.
  double log_prior(const Bank& bank) const;
};

struct AscentLimits {
  Index max_iterations = 100;
  double tolerance = 1e-6;  ///< nats per transition: converged when no more is to be gained
};

struct LikelihoodMaximum {
  Bank bank;
  double value = 0.0;  ///< of the target there; never below the start's
  Index iterations = 0;
  MeasuredFit end = MeasuredFit::stalled;
  bool rose = false;  ///< converged at the start, or somewhere better
};

/// The target's maximum near `start` by BFGS (ceres::GradientProblemSolver) over BankCoordinates in units of the
/// standard errors: the gradients of single samples give both the gradient and the information (information.hpp), in
/// whose metric the problem is nearly round. Gradients go back over the filter's steps (likelihood_gradient.hpp), or
/// are central differences where a filter has no such way. Converged means that a Newton step with that information
/// would gain less than the tolerance, and less than 1e-3 nats in all, a twentieth of a standard error.
LikelihoodMaximum maximise_likelihood(const LikelihoodTarget& target, const FreeParameters& free, const Bank& start,
                                      const AscentLimits& limits);

}  // namespace modebank
