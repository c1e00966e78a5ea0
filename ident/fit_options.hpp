#pragma once

#include <Eigen/Core>

#include "ident/local_model.hpp"

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

/// How windows are cut and fitted. Defaults are the recommended method.
struct FitOptions {
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
};

}  // namespace modebank
