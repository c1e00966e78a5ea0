#pragma once

#include <cstdint>
#include <vector>

#include "ident/base/log_two_pi.hpp"
#include "ident/fit/constants.hpp"
#include "ident/model/local_model.hpp"
#include "ident/model/transitions.hpp"

/// What passes between the batch solver's host code and its vector kernels: plain numbers and pointers, since a kernel
/// is compiled once per instruction set.
namespace modebank::batch {

/// Regressors q of one state that the kernels are compiled for: three lags of the state, two inputs and an intercept.
inline constexpr int max_regressors = 6;
/// Rows of samples that a kernel may read beyond the last window: one vector of the widest instruction set.
inline constexpr Index padding = 8;

/// Two rows of a column of residuals to be put in order: the smaller goes to `low`.
struct Comparator {
  std::int32_t low = 0;
  std::int32_t high = 0;
};

/// What all windows of a fit have in common. The objective of a window, per unit of sigma^2, is
/// sum_k rho(r_k^2 / sigma^2) + sum_j ((theta_j - mean_j) / sd_j)^2 with r_k = y_k - phi_k' theta.
struct Settings {
  int regressors = 1;  ///< q = p, one state
  Index length = 1;    ///< L
  Index step = 1;      ///< samples between window starts
  Loss loss = Loss::huber;
  double loss_scale = huber_tuning;   ///< c in units of sigma
  double huber_scale = huber_tuning;  ///< of the Huber optimum that non-convex losses start from
  double consistency = 1.0;           ///< gaussian_consistency of the loss
  bool own_scale = true;              ///< sigma is each window's own; else Chunk::sigma
  double floor = 0.0;                 ///< least sigma
  bool prior = false;
  double prior_mean[max_regressors] = {};
  double prior_sd[max_regressors] = {};
  CovarianceKind covariance = CovarianceKind::model;
  int max_iterations = 100;
  std::vector<Comparator> sort;    ///< puts L values in order
  std::vector<Comparator> median;  ///< the part of it that decides the middle
};

/// Consecutive windows of one run; window w covers rows w step .. w step + L - 1 of every column. Columns hold
/// `padding` finite rows more than the windows need.
struct Chunk {
  Index windows = 0;
  const double* regressors[max_regressors] = {};
  const double* increments = nullptr;
  const double* present =
      nullptr;         ///< 1, or 0 for a left-out transition, whose regressors and increment are then 0; or null
  double sigma = 1.0;  ///< for windows without a scale of their own
};

/// What became of a window; all but `solved` are left to Ceres.
enum class Verdict : std::uint8_t { solved, ill_conditioned, rank_deficient, too_few_samples, not_converged, failed };

/// Where results go: one column per window of the chunk, laid out as in WindowFits. Null: not wanted.
struct Output {
  Verdict* verdict = nullptr;
  double* theta = nullptr;                ///< p
  double* covariance = nullptr;           ///< p x p
  double* noise_variance = nullptr;       ///< 1
  double* condition = nullptr;            ///< 1
  double* information = nullptr;          ///< p
  double* inlier_fraction = nullptr;      ///< 1
  double* r_squared = nullptr;            ///< 1
  double* aic = nullptr;                  ///< 1
  double* weighed_information = nullptr;  ///< 1
  int* transitions = nullptr;
  int* rank = nullptr;
  int* status = nullptr;
  double* gradient = nullptr;  ///< relative gradient at theta, before the last Newton step (for tests and benchmarks)
};

/// Vectors' worth of scratch that a kernel needs per row of a window: staged columns, an orthogonal basis, residuals.
inline constexpr Index scratch_columns = 2 * (max_regressors + 3);
/// In doubles, for windows of `length`; the memory must be aligned to 64 bytes.
inline Index scratch_doubles(Index length) { return scratch_columns * padding * length; }

}  // namespace modebank::batch
