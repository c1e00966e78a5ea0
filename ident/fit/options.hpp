#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>

#include "ident/model/local_model.hpp"

namespace modebank {

/// Where the residual scale sigma of a window comes from.
enum class ScaleSource { window, run, fixed };

template <>
struct EnumNames<ScaleSource> {
  static constexpr Names<3> values{"window", "run", "fixed"};
};

enum class Prior { none, global };

template <>
struct EnumNames<Prior> {
  static constexpr Names<2> values{"none", "global"};
};

/// Who minimises: Ceres window by window (`minimise`; motion models `minimise_model`), or the batch solver, many linear
/// windows of one state at a time, with Ceres for those it hands back. automatic: Ceres for up to most_ceres_windows
/// windows, the batch solver for more wherever it has kernels; this depends on the stage's inputs alone.
enum class WindowSolver { ceres, batch, automatic };

template <>
struct EnumNames<WindowSolver> {
  static constexpr Names<3> values{"ceres", "batch", "auto"};
};

/// What Ceres does in some 1.4 s of one core, the default prior's fits included: nobody waits for less, and a stage of
/// more is ten times as fast by the batch solver.
inline constexpr Eigen::Index most_ceres_windows = 20000;

/// How windows are cut and fitted. Defaults are the recommended method.
struct FitOptions {
  std::string model = "linear";  ///< linear, varx, or one of motion_model_names()
  Index state_lags = 1;          ///< varx: see LinearStructure
  Index input_lags = 1;
  Index input_delay = 1;
  double wheel_radius_m = 1.0;  ///< motion models: see ModelSettings
  ResidualKind residual = ResidualKind::one_step;
  Index length = 25;  ///< transitions per window
  Index step = 1;     ///< transitions between window starts
  Loss loss = Loss::huber;
  double loss_scale = 0.0;  ///< in units of sigma; 0: 95 % efficiency at the normal (see default_loss_scale)
  ScaleSource scale = ScaleSource::window;
  double sigma = 0.0;  ///< residual standard deviation for ScaleSource::fixed [state unit], > 0
  Prior prior = Prior::global;
  Eigen::VectorXd prior_sd;  ///< p standard deviations; one value: for all; empty: 3 x the spread of full-rank fits
  bool intercept = false;
  CovarianceKind covariance = CovarianceKind::model;
  int max_iterations = 100;  ///< of the minimiser
  WindowSolver solver = WindowSolver::automatic;
  std::uint64_t seed = 1;  ///< of the samples of windows that are audited and that the default prior is made from
};

inline bool is_linear(const FitOptions& options) { return options.model == "linear" || options.model == "varx"; }

/// The linear model that the options name, for n states and m inputs; of a motion model the structure of its
/// linearisations, with an intercept.
inline LinearStructure linear_structure(Index states, Index inputs, const FitOptions& o) {
  if (o.model == "varx") return {states, inputs, o.intercept, o.state_lags, o.input_lags, o.input_delay};
  return {states, inputs, is_linear(o) ? o.intercept : true};
}

}  // namespace modebank
