#pragma once

#include <Eigen/Core>

#include "filter/bank.hpp"
#include "filter/sample_feed.hpp"
#include "filter/switching_regression.hpp"
#include "ident/trajectory.hpp"

namespace modebank {

/// What a switching state space model's maximisation needs to know of the training runs: expected sums given all
/// measurements, where the states are not measured exactly (R > 0).
struct StateSpaceSums {
  SwitchingSums switching;
  Eigen::VectorXd residuals;     ///< n_y, sum of E[(y - C x)_i^2] over the measurements of signal i
  Eigen::VectorXd measurements;  ///< n_y, how many those are
};

/// The expectation step of Shumway & Stoffer (1991, J. Amer. Statist. Assoc. 86) with the sums of Shumway & Stoffer
/// (1982), both taken from Kim's (1994) smoother on the IMM filter's estimates: exact for one mode, an approximation
/// (one Gaussian per mode instead of one per history) for several. A run's first measurements count as measurements of
/// a state of which nothing was known. Requires C = [I 0], as learned banks have it.
StateSpaceSums smooth_states(const Bank& bank, const Recording& recording, const SwitchingPrior& prior,
                             TimeSteps time_steps);

/// Mean of the training samples' positive weights, which only count in ratios; 1 without weights.
double mean_training_weight(const Recording& recording);

/// One step of expectation-maximisation: theta, Q, T and first modes as maximise does, R_ii = residuals_i /
/// measurements_i, but at least `least_R`, unless R is known (`estimate_R` false).
void step_state_space(const Recording& recording, const SwitchingPrior& prior, SharedParts shared, TimeSteps time_steps,
                      const Eigen::VectorXd& least_R, bool estimate_R, Bank& bank);

}  // namespace modebank
