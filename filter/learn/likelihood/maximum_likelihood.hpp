#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <vector>

#include "filter/learn/switching/regression.hpp"
#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"
#include "modebank/filter/options.hpp"
#include "modebank/learn/results.hpp"

namespace modebank {

/// Largest number of state lags with which R is estimated. With more, lag coefficients can replace R.
inline constexpr Eigen::Index most_lags_beside_R = 8;

/// Which parameters of a bank are estimated beside Q, and their units.
struct FreeParameters {
  Eigen::MatrixXd theta_unit = {};   ///< p x number of motions, positive; empty if theta is known
  Eigen::VectorXd least_Q = {};      ///< n, lower bounds of every Q's diagonal [state unit^2]; empty if there are none
  std::vector<Eigen::Index> R = {};  ///< outputs whose variance is estimated
  Eigen::VectorXd least_R = {};      ///< n_y, lower bounds of R's diagonal [state unit^2]
  bool transition = true;            ///< true: T is estimated; false: T is known
};

/// Unconstrained coordinates of all estimated parameters, relative to one bank, the origin:
///   theta_j       = theta0_j + unit z (one coordinate per parameter);
///   Q_j           = L0 M M' L0' with L0 L0' = Q0_j, M lower triangular, exp(z) on its diagonal (log-Cholesky: Pinheiro
///                   & Bates 1996), its diagonal at least least_Q; with noise levels for the first mode of a motion,
///                   and Q_ml = exp(z_l) Q0_ml / Q0_m0 Q_m0 for the others;
///   R_ii          = least_R_i + max(R0_ii - least_R_i, 0) exp(z);
///   row i of T    proportional to T0_ij exp(z_j), z = 0 for its largest entry; with noise levels, of both its factors.
/// Modes of one motion have one theta.
class BankCoordinates {
 public:
  BankCoordinates(Bank origin, FreeParameters free);

  Eigen::Index size() const;
  const Bank& origin() const { return origin_; }
  const FreeParameters& free() const { return free_; }
  /// The bank at these coordinates; zero is the origin.
  Bank decode(const Eigen::VectorXd& at) const;

  /// Derivative at the origin, q x size(), of theta, the lower triangle of Q (column by column, measured states) and
  /// the row of T of each mode in turn, then R of the estimated outputs.
  Eigen::MatrixXd jacobian() const;

 private:
  Bank origin_;
  FreeParameters free_;
};

/// Log-likelihood of all training runs [nats], each from its second sample, summed in a fixed order.
double training_log_likelihood(const Bank& bank, const Recording& recording, const FilterOptions& options);

/// The objective: the filter's log-likelihood of the training runs plus the prior's log density.
struct LikelihoodTarget {
  const Recording& recording;
  FilterOptions filter;                 ///< variant `imm` if there are several modes
  std::optional<SwitchingPrior> prior;  ///< if empty, the target is the likelihood without a prior

  /// Minus infinity for a bank with non-finite numbers.
  double value(const Bank& bank) const;
  /// The prior's part; 0 without a prior.
  double log_prior(const Bank& bank) const;
};

struct AscentLimits {
  Index max_iterations = 100;
  double tolerance = 1e-6;  ///< nats per transition; the search has converged if the expected gain is at most this
};

struct LikelihoodMaximum {
  Bank bank;
  double value = 0.0;  ///< value of the target at the result; never below the value at the start
  Index iterations = 0;
  MeasuredFit end = MeasuredFit::stalled;
};

/// Finds the target's maximum near `start`, by BFGS (ceres::GradientProblemSolver) over BankCoordinates in units of the
/// standard errors (observed_information), in which all directions curve about equally. The gradient is computed by the
/// adjoint of the filter's steps (likelihood_gradient.hpp), or else by central differences.
LikelihoodMaximum maximise_likelihood(const LikelihoodTarget& target, const FreeParameters& free, const Bank& start,
                                      const AscentLimits& limits);

/// Information of the training runs and of the prior about the coordinates, at the origin: the sum of the outer
/// products of the samples' gradients (Berndt, Hall, Hall & Hausman 1974, Annals of Economic and Social Measurement
/// 3(4)), by central differences with `steps` (one per coordinate). From more than `most` transitions, stretches of all
/// runs are taken (left_out/folds.hpp), and the sum is scaled up.
Eigen::MatrixXd observed_information(const LikelihoodTarget& target, const BankCoordinates& around,
                                     const Eigen::VectorXd& steps, Index most);

/// The bank with standard errors given the smoothed modes: theta's by its posterior covariance, NaN if that is not
/// definite; Q's by the variance of a normal scatter, (Q_ii Q_jj + Q_ij^2) / W; T's by a binomial distribution.
Bank with_complete_errors(const TrainingTransitions& transitions, const ModePosterior& posterior,
                          const SwitchingPrior& prior, Bank bank);

/// All parameters of a bank as free parameters, with theta in units of the bank's standard errors. `estimate_R`:
/// includes R of all outputs, at least `least_R` (n_y). The weights of a logit are known.
FreeParameters all_parameters(const Bank& bank, bool estimate_R, const Eigen::VectorXd& least_R);

/// The bank with standard errors from the inverse of the observed information for all parameters together. So they
/// include the uncertainty of the modes and, for R > 0, of the states. If the information is singular, the errors that
/// `bank` has stay, and those of R are NaN. `free`: all_parameters of the same bank.
Bank with_standard_errors(const LikelihoodTarget& target, const FreeParameters& free, Bank bank);

}  // namespace modebank
