#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "modebank/base/names.hpp"
#include "modebank/ident/input_delays.hpp"

namespace modebank {

/// How a window's fit ended. The numbers are those of /windows/status in the archive. converged: the search reached its
/// tolerance. iteration_limit: the search stopped at max_iterations. rank_deficient: the window's data do not determine
/// all parameters, however the search ended. failed: the window has no estimate.
enum class FitStatus : int { converged = 0, iteration_limit = 1, rank_deficient = 2, failed = 3 };

/// Robust losses rho(s) of s = |r|^2, as defined by Ceres.
enum class Loss { trivial, huber, cauchy, softlone, tukey, arctan };

template <>
struct EnumNames<Loss> {
  static constexpr Names<6> values{"trivial", "huber", "cauchy", "softlone", "tukey", "arctan"};
};

/// Reported covariance of theta: `model` (Huber 1981) or `sandwich` (HC3).
enum class CovarianceKind { model, sandwich };

template <>
struct EnumNames<CovarianceKind> {
  static constexpr Names<2> values{"model", "sandwich"};
};

/// Gaussian prior on a window's parameters: no prior, or a prior centred on the global model of all training runs.
enum class Prior { none, global };

template <>
struct EnumNames<Prior> {
  static constexpr Names<2> values{"none", "global"};
};

/// Solver of the window fits. `ceres`: one window at a time. `batch`: many linear windows of one state at a time; Ceres
/// fits the windows that the batch solver cannot fit. `automatic`: Ceres for up to most_ceres_windows windows; for more
/// windows, the batch solver if it has kernels for the model. The choice depends on the runs and the options alone.
enum class WindowSolver { ceres, batch, automatic };

template <>
struct EnumNames<WindowSolver> {
  static constexpr Names<3> values{"ceres", "batch", "auto"};
};

/// In about 1.4 s Ceres solves this number of windows on one core, including the fits for the default prior. For more
/// windows the batch solver is ten times as fast.
inline constexpr std::ptrdiff_t most_ceres_windows = 20000;

/// Options for cutting and fitting windows. Defaults are the recommended method.
struct FitOptions {
  std::string model = "linear";   ///< linear, varx (linear with lags), or the name of a motion model
  std::ptrdiff_t state_lags = 1;  ///< varx: samples x[k], x[k-1], ... that predict x[k+1]
  std::ptrdiff_t input_lags = 1;  ///< varx: number of input samples that act on one transition
  InputDelays input_delay = 1;    ///< varx: samples from each input to its first effect
  double wheel_radius_m = 1.0;    ///< motion models: converts wheel speeds from rad/s to m/s; 1 for inputs in m/s
  std::ptrdiff_t length = 25;     ///< transitions per window
  std::ptrdiff_t step = 1;        ///< transitions between window starts
  Loss loss = Loss::huber;        ///< loss applied to each sample's residual
  double loss_scale = 0.0;        ///< threshold of the robust loss in units of sigma; 0 gives 95 % efficiency at the
                                  ///< normal distribution
  double sigma = 0.0;             ///< residual standard deviation [state unit]; 0: estimated for each window
  Prior prior = Prior::global;    ///< prior on a window's parameters
  std::vector<double> prior_sd;   ///< p standard deviations; a single value holds for all parameters; if empty, 3 x the
                                  ///< standard deviation over full-rank fits
  bool intercept = false;         ///< whether linear models have a constant term c
  std::vector<double> centre;     ///< n states, then m inputs: with an intercept, theta is taken about this point;
                                  ///< empty: zero. Learning takes the means of the training runs
  CovarianceKind covariance = CovarianceKind::model;  ///< reported covariance of theta
  int max_iterations = 100;                           ///< iteration limit of the solver
  WindowSolver solver = WindowSolver::automatic;      ///< solver of the window fits
  std::uint64_t seed = 1;                             ///< seed for the random choice of windows for the default prior
};

}  // namespace modebank
