#pragma once

#include <cstdint>
#include <vector>

#include "ident/fit/constants.hpp"
#include "ident/model/local_model.hpp"
#include "ident/model/transitions.hpp"

/// Plain numbers and pointers that the batch solver's host code passes to its vector kernels. Kernels are compiled once
/// per instruction set, so this file must not use classes with inline code.
namespace modebank::batch {

/// Largest number of regressors q of one state with a compiled kernel: three state lags, two inputs and an intercept.
inline constexpr int max_regressors = 6;
/// Rows beyond the last window that a kernel may read: one vector of the widest instruction set.
inline constexpr Index padding = 8;

/// A comparator of a sorting network. Of two rows of a residual column, the smaller goes to `low`.
struct Comparator {
  std::int32_t low = 0;
  std::int32_t high = 0;
};

/// The settings shared by all windows of a fit. A window's objective, per unit of sigma^2, is sum_k rho(r_k^2 /
/// sigma^2) + sum_j ((theta_j - mean_j) / sd_j)^2 with r_k = y_k - phi_k' theta.
struct Settings {
  int regressors = 1;  ///< q; equal to p, because there is one state
  Index length = 1;    ///< L
  Index step = 1;      ///< samples between window starts
  Loss loss = Loss::huber;
  double loss_scale = huber_tuning;   ///< tuning constant c in units of sigma
  double huber_scale = huber_tuning;  ///< Huber threshold of the first stage; non-convex losses start from its optimum
  double consistency = 1.0;           ///< result of `gaussian_consistency` for the loss
  double sigma = 0.0;                 ///< sigma of all windows; 0: each window has its own
  double floor = 0.0;                 ///< smallest sigma
  bool prior = false;
  double prior_mean[max_regressors] = {};
  double prior_sd[max_regressors] = {};
  CovarianceKind covariance = CovarianceKind::model;
  int max_iterations = 100;
  std::vector<Comparator> sort;    ///< comparators that sort L values
  std::vector<Comparator> median;  ///< the comparators of `sort` that determine the median
};

/// Consecutive windows of one run. Window w covers rows w step .. w step + L - 1 of every column. Columns have
/// `padding` further finite rows.
struct Chunk {
  Index windows = 0;
  const double* regressors[max_regressors] = {};
  const double* increments = nullptr;
  const double* present = nullptr;  ///< 1 per transition, or 0 for an excluded transition, whose regressors and
                                    ///< increment are then 0; may be null
};

/// How the solver ended for a window. Ceres solves all windows with other verdicts than `solved`.
enum class Verdict : std::uint8_t { solved, ill_conditioned, rank_deficient, too_few_samples, not_converged, failed };

/// Memory for results: one column per window of the chunk, with the layout of WindowFits. A null pointer means that the
/// result is not computed.
struct Output {
  Verdict* verdict = nullptr;
  double* theta = nullptr;                ///< p
  double* covariance = nullptr;           ///< p x p
  double* noise_variance = nullptr;       ///< 1
  double* condition = nullptr;            ///< 1
  double* information = nullptr;          ///< p
  double* inlier_fraction = nullptr;      ///< 1
  double* r_squared = nullptr;            ///< 1
  double* weighed_information = nullptr;  ///< 1
  int* transitions = nullptr;
  int* rank = nullptr;
  int* status = nullptr;
};

/// Scratch vectors per row of a window: staged columns, an orthogonal basis and residuals.
inline constexpr Index scratch_columns = 2 * (max_regressors + 3);
/// Scratch size in doubles for windows of `length`; the memory must be aligned to 64 bytes.
inline Index scratch_doubles(Index length) { return scratch_columns * padding * length; }

}  // namespace modebank::batch
