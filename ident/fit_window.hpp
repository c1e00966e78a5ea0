#pragma once

#include <functional>

#include "ident/fit_options.hpp"
#include "ident/local_model.hpp"
#include "ident/trajectory.hpp"

namespace modebank {

/// Tuning constant, in units of sigma, that gives 95 % efficiency under Gaussian noise in one state (Holland & Welsch
/// 1977; softlone and arctan solved from the same condition; 1 for trivial).
double default_loss_scale(Loss loss);

/// Plain least squares over all transitions of the training runs. Throws DataError when they cannot identify theta
/// at all (no transition); a rank-deficient regressor gives the minimum-norm solution. Sample weights make it weighted
/// least squares, N the number of transitions of positive weight.
GlobalModel fit_global(const Recording& recording, const LinearStructure& structure);

/// Gaussian prior on theta, independent per parameter.
struct ParameterPrior {
  Eigen::VectorXd mean;  ///< p
  Eigen::VectorXd sd;    ///< p
};

/// Fits one window as a robust Ceres problem: residual r_k = (x[k+1] - x[k] - [A B c] phi_k) / sigma, one loss per
/// sample on |r_k|^2 over its n states. Assumes independent residuals of standard deviation `sigma` (n entries, the
/// state's unit) apart from outliers. `prior` may be null. Rank deficiency is a status of the result, never an
/// exception, and takes precedence over iteration_limit. Transitions that hold a NaN or infinity are left out, L counts
/// the others. Status failed (theta NaN): no transition is left, or numbers overflow.
///
/// Sample weights w_k (Trajectory::weight) multiply the losses: the fit minimises sum w_k rho(|r_k|^2), w_k divided by
/// their mean over the window, so that a common factor changes nothing, not even against the prior. Least squares: the
/// noise variance of transition k is taken as noise_variance / w_k, as statsmodels' WLS does. rank and condition are
/// those of the regressors times sqrt(w_k), robust_scale weighs its medians.
///
/// noise_variance: sigma^2 sum w_k r_k^2 / [(L - rank) kappa], w_k = rho' the robust weight and kappa = E[w z^2] for
/// Gaussian z, which makes it consistent for the variance of Gaussian noise (rank: of one state's regressors). Not
/// above L = q: sum of squared residuals about the posterior / L. Never below the square of `sigma_floor` (n entries,
/// or empty: none), nor is the residual variance of the `model` covariance. Throws std::invalid_argument for a range
/// outside the run or sizes and signs that do not fit.
LocalModel fit_window(const Trajectory& run, Index start, const LinearStructure& structure, const FitOptions& options,
                      const Eigen::VectorXd& sigma, const ParameterPrior* prior,
                      const Eigen::VectorXd& sigma_floor = {});

/// Cuts and fits every window of the training runs (in parallel on oneTBB; result i depends on window i and the global
/// model and prior alone). sigma is the window's robust_scale, or its run's (ScaleSource::run, and for L <= q), floored
/// by scale_floor. Linear models of one state go through the batch solver (options.solver), whose answers are audited.
/// The default prior is made from all full-rank windows, or from 200,000 windows drawn at random, 64 consecutive ones
/// at a time, where there are more. Throws DataError when there is no window: no training run has options.length
/// transitions; ConfigurationError for an option out of range.
WindowFits fit_windows(const Recording& recording, const FitOptions& options);

/// Windows that fit_windows will return.
Index count_windows(const Recording& recording, const FitOptions& options);

/// The same fits in bounded memory: `sink` gets them in order, some ten thousand windows at a time, beginning with
/// index `first`; everything but the windows themselves is filled in each time, the audit up to there. Returns what
/// they have in common, without windows. Linear models only (is_linear, one-step residuals).
using WindowSink = std::function<void(const WindowFits& fits, Index first)>;
WindowFits stream_windows(const Recording& recording, const FitOptions& options, const WindowSink& sink);

}  // namespace modebank
