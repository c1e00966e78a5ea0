#pragma once

#include <array>
#include <optional>
#include <vector>

#include "filter/learn/refine/refine.hpp"
#include "ident/lag/linear_stage.hpp"

/// The filters that a bank competes with (method: section 6). Each learns from the training runs of a recording, and
/// throws DataError without usable transitions.
namespace modebank {

/// One Kalman filter on the global model, and how the search for its Q and R ended.
struct Baseline {
  Bank bank;                    ///< K = 1
  double log_likelihood = 0.0;  ///< of the training runs, without each run's first sample
  bool converged = false;
  bool at_bound = false;  ///< whether R is at its lower bound (1e-8 of the residual variance), or 0 with many lags
};

/// theta is the global least-squares estimate; Q (full) and R (diagonal) maximise the exact Gaussian likelihood. For
/// rounded states all three do, with R of at least the variance of rounding. With more than most_lags_beside_R lags, R
/// is 0 and Q is the residual covariance.
Baseline learn_baseline(const Recording& recording, const GlobalModel& global, const LinearStructure& structure);

/// One Kalman filter with theta, Q and R of the linear stage. Differences become levels with a pole at 1 and without a
/// constant. `variance`: stated R of every state.
Bank bank_of(const Recording& recording, const ArmaxFit& fit, std::optional<double> variance);

/// bank_of the fit of this structure to the training runs; empty where the runs are too short for it.
std::optional<Bank> learn_armax(const Recording& recording, const ArmaxStructure& structure,
                                std::optional<double> variance);

/// The competitor with switching noise only: Huber's theta, eight noise scales in geometric steps, and the most likely
/// `stay`. If states are rounded, theta and the scales then maximise the filter's likelihood, whose R has the rounding.
Bank learn_noise_only(const Recording& recording, const LinearStructure& structure, const Eigen::MatrixXd& R);

/// The same competitor beside a baseline. If that is the linear stage's, whose R is known beside Q: its theta and R
/// with eight levels of its Q, from a quarter to 32 times (residuals of exact states count R twice), if these are more
/// likely on the training runs.
Bank noise_only_beside(const Bank& baseline, bool of_linear_stage, const Recording& recording,
                       const LinearStructure& structure);

/// The competitor with one motion, learned like the bank (refine_bank), but with one theta for all modes. It starts
/// from `most_levels` noise scales and fewer, down to one, and from the noises and transitions of `rival`, the bank
/// that it competes with. `frame`: structure and global model in linear form; length, step and prior of windows with
/// this structure.
Refinement learn_one_motion(const Recording& recording, const WindowFits& frame, const Bank& rival,
                            const Eigen::MatrixXd& R, Eigen::Index most_levels, const BankOptions& options);

/// The competitor with one nonlinear motion, learned as in learn_one_motion from up to four noise levels; a wide level
/// is added. Terms are known inputs of a transition, because states count as measured exactly. `structure`: with the
/// lags of the terms.
Bank learn_nonlinear(const Recording& recording, const LinearStructure& structure, const MotionTerms& terms,
                     const RefineOptions& em);

/// The settings of a drifting model to choose from (method: section 6). Of settings with equal scores, the earlier one
/// is preferred. q, p0 and floor ascend, leak descends.
struct DriftingGrid {
  std::vector<double> q{0.0, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1};
  std::vector<double> p0{0.0, 1e-2, 1e-1, 1.0, 10.0};
  std::vector<double> leak{1.0, 0.97, 0.9};
  std::vector<double> lam{0.5, 0.6, 0.7, 0.75, 0.8, 0.85, 0.92, 0.96};
  std::vector<double> nu{0.0, 3.0, 5.0, 8.0, 15.0};
  std::vector<double> floor{1e-6, 1e-5, 1e-4, 1e-3};  ///< as a share of the variance of the training residuals

  /// The settings of a point in this order; those of the last change fastest.
  std::array<double, 6> point(Eigen::Index index) const;
};

/// The log score of the training runs at every point of the grid [nats/sample].
struct DriftingScores {
  Eigen::VectorXd log_score;
  Eigen::Index samples = 0;  ///< scored samples, all of equal weight

  /// The grid point with the highest score; the first one if several are equal.
  Eigen::Index best() const;
};

/// Scores the grid for the competitor `drifting`. `start`: a bank with theta, scale and Q from the training runs; its
/// other settings are ignored. Each (q, p0, leak) has one recursion of the coefficients, from which all running
/// variances and densities follow. Throws std::invalid_argument for an empty grid, DataError if no sample is scored.
DriftingScores score_drifting_grid(const Bank& start, const Recording& recording, const DriftingGrid& grid);

/// Learns `drifting` with one noise level. `global`: least squares of this structure on the training runs. The settings
/// have the best log score of the training runs one sample ahead. Each of `horizons` from 2 on has a factor on the
/// variance: the one of 2^(-4), 2^(-3.75), ..., 2^8 that makes the training errors most likely.
Bank learn_drifting(const Recording& recording, const GlobalModel& global, const LinearStructure& structure,
                    const std::vector<Eigen::Index>& horizons, const DriftingGrid& grid = {});

/// The model with noise levels: the variances of the modes of `one_motion`, which differ in noise alone, and their
/// transition matrix. All other settings are chosen again: two climbs, setting by setting, to the best log score of the
/// training runs one sample ahead. `drifting` itself if it scores as well there, or if `one_motion` has one level.
Bank with_noise_levels(const Bank& drifting, const Bank& one_motion, const Recording& recording,
                       const std::vector<Eigen::Index>& horizons);

/// A model with the settings of `like`. theta0 and the variances come from these training runs.
Bank relearn_drifting(const Bank& like, const Recording& recording, const GlobalModel& global);

}  // namespace modebank
