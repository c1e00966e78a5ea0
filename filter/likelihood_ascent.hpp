#pragma once

#include <Eigen/Core>

#include "filter/bank.hpp"
#include "filter/evaluate.hpp"
#include "filter/measured_fit.hpp"
#include "filter/switching_regression.hpp"
#include "ident/trajectory.hpp"

namespace modebank {

/// What is maximised over a bank's theta, Q, T and R: the filter's log-likelihood of the training runs plus the prior's
/// log density; a sample's weight is the power of its density. The likelihood is exact for one mode and the IMM's
/// approximation for several.
struct LikelihoodTarget {
  const Recording& recording;
  FilterOptions filter;  ///< variant imm for several modes
  SwitchingPrior prior;
  SharedParts shared = SharedParts::none;
  Eigen::VectorXd least_R;  ///< n_y, lower bounds of R's diagonal
  bool estimate_R = true;   ///< false: R is known

  double value(const Bank& bank) const;
};

struct AscentLimits {
  Index max_iterations = 100;
  double tolerance = 1e-6;  ///< nats per transition: converged when no more is to be gained
};

struct Ascent {
  Index iterations = 0;
  MeasuredFit end = MeasuredFit::stalled;
  double value = 0.0;  ///< of the target at the end
};

/// Raises the target from `bank` to its maximum nearby by BFGS (ceres::GradientProblemSolver) over BankCoordinates in
/// units of the standard errors: the scores of single samples give both the gradient and Berndt, Hall, Hall & Hausman's
/// (1974) information, in whose metric the problem is nearly round. Gradients are central differences. Converged means
/// that a Newton step with that information would gain less than the tolerance, and less than 1e-3 nats in all, a
/// twentieth of a standard error. The value never falls.
Ascent raise_likelihood(const LikelihoodTarget& target, const AscentLimits& limits, Bank& bank);

}  // namespace modebank
