#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "modebank/base/names.hpp"

namespace modebank {

/// How a window's fit ended; the numbers are those of /windows/status in the archive. converged: the search reached its
/// tolerance. iteration_limit: it did not within max_iterations. rank_deficient: the window's data alone do not
/// determine all parameters, however the search ended. failed: there is no estimate.
enum class FitStatus : int { converged = 0, iteration_limit = 1, rank_deficient = 2, failed = 3 };

/// Robust losses rho(s) of s = |r|^2 as Ceres defines them.
enum class Loss { trivial, huber, cauchy, softlone, tukey, arctan };

template <>
struct EnumNames<Loss> {
  static constexpr Names<6> values{"trivial", "huber", "cauchy", "softlone", "tukey", "arctan"};
};

/// Which covariance of theta is reported (method: Huber 1981 for `model`, HC3 for `sandwich`).
enum class CovarianceKind { model, sandwich };

template <>
struct EnumNames<CovarianceKind> {
  static constexpr Names<2> values{"model", "sandwich"};
};

/// Where the residual scale sigma of a window comes from: the window's own residuals, those of its run, or a given
/// number.
enum class ScaleSource { window, run, fixed };

template <>
struct EnumNames<ScaleSource> {
  static constexpr Names<3> values{"window", "run", "fixed"};
};

/// The Gaussian prior on a window's parameters: none, or about the global model of all training runs.
enum class Prior { none, global };

template <>
struct EnumNames<Prior> {
  static constexpr Names<2> values{"none", "global"};
};

/// Who minimises: Ceres window by window, or the batch solver, many linear windows of one state at a time, with Ceres
/// for those it hands back. automatic: Ceres for up to most_ceres_windows windows, the batch solver for more wherever
/// it has kernels; this depends on the runs and the options alone.
enum class WindowSolver { ceres, batch, automatic };

template <>
struct EnumNames<WindowSolver> {
  static constexpr Names<3> values{"ceres", "batch", "auto"};
};

/// What Ceres does in some 1.4 s of one core, the default prior's fits included: nobody waits for less, and a stage of
/// more is ten times as fast by the batch solver.
inline constexpr std::ptrdiff_t most_ceres_windows = 20000;

/// How windows are cut and fitted. Defaults are the recommended method.
struct FitOptions {
  std::string model = "linear";    ///< linear, varx (linear with lags), or the name of a motion model
  std::ptrdiff_t state_lags = 1;   ///< varx: samples x[k], x[k-1], ... that predict x[k+1]
  std::ptrdiff_t input_lags = 1;   ///< varx: input samples that act on one transition
  std::ptrdiff_t input_delay = 1;  ///< varx: samples from an input to its first effect; 0: u[k+1] acts on x[k+1]
  double wheel_radius_m = 1.0;     ///< motion models: turns wheel speeds in rad/s into m/s; 1 for inputs in m/s
  std::ptrdiff_t length = 25;      ///< transitions per window
  std::ptrdiff_t step = 1;         ///< transitions between window starts
  Loss loss = Loss::huber;         ///< of a sample's residual
  double loss_scale = 0.0;         ///< in units of sigma; 0: 95 % efficiency at the normal
  ScaleSource scale = ScaleSource::window;  ///< where sigma comes from
  double sigma = 0.0;                       ///< residual standard deviation for ScaleSource::fixed [state unit], > 0
  Prior prior = Prior::global;              ///< on a window's parameters
  std::vector<double> prior_sd;  ///< p standard deviations; one value: for all; empty: 3 x the spread of full-rank fits
  bool intercept = false;        ///< whether linear models have a constant term c
  CovarianceKind covariance = CovarianceKind::model;  ///< of theta, that is reported
  int max_iterations = 100;                           ///< of the minimiser
  WindowSolver solver = WindowSolver::automatic;      ///< who minimises
  std::uint64_t seed = 1;  ///< of the samples of windows that are audited and that the default prior is made from
};

}  // namespace modebank
