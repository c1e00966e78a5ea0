#pragma once

#include <optional>
#include <vector>

#include "filter/learn/likelihood/maximum_likelihood.hpp"
#include "filter/learn/refine/cross_validation.hpp"
#include "filter/learn/refine/fit.hpp"
#include "filter/learn/refine/refine.hpp"
#include "filter/learn/switching/transition_regression.hpp"
#include "filter/learn/tuning.hpp"

namespace modebank {

/// Result of a search for R.
struct MeasurementNoise {
  std::optional<Bank> bank;  ///< bank with R and a smaller Q; empty if R does not gain, or if every start failed
  Index starts = 0;
  Index failed_starts = 0;  ///< number of starts that failed: the likelihood is not finite, or no step raised it
};

/// The bank with maximum-likelihood R (diagonal). The target is maximised over R and one factor on every Q. (Q must
/// become smaller, because it included the measurement noise.) theta and T are constant. Several starting shares of Q
/// are tried, and the best result is taken. Empty unless it gains more than least_gain nats per sample over the bank
/// without R. For several modes and R > 0 the likelihood of an IMM is itself approximate.
MeasurementNoise estimate_measurement_noise(const LikelihoodTarget& target, const Bank& bank,
                                            const RefineTuning& tuning);

/// Whether at least half of the banks have an R of at least a tenth of this one (traces).
bool mostly_have(const std::vector<Bank>& banks, const Eigen::MatrixXd& R);

/// The prior for unknown states. It equals the prior of the fit with exactly measured states, except for Q. Q has one
/// additional transition, with the harmonic mean covariance of the modes in `start`. (The global residual covariance
/// would include the differences between modes and outweigh the data of very different modes.) A harmonic mean is at
/// most a few times the smallest Q. So the prior hardly raises Q of any mode.
SwitchingPrior prior_with_states_unknown(const SwitchingPrior& exact, const Bank& start, const RefineTuning& tuning);

/// Continues the fit with unknown states if R is not negligible.
/// - R is given, or estimated in the bank's filter (estimate_measurement_noise). An estimate is accepted unless
///   left-out runs lose more than least_gain, and only if the splits mostly_have it.
/// - theta, Q, R and T then maximise the filter's likelihood together. The result is kept if it gains on left-out
///   runs. Each run is scored by a fit whose R, prior and other parameters come from the other runs.
/// - Rounded states are unknown: R is at least the variance of rounding. Their fit always continues in this way, and
///   more R is searched afterwards, because the likelihood then already explains the rounding.
/// - With more than eight state lags, R is not searched.
/// `exact`: the fit with exact states, with its bank and prior. `stage` records the result.
Fit fit_with_measurement_noise(const RefineInput& in, const CrossValidation& validation, const Fit& exact,
                               MeasurementStage& stage);

}  // namespace modebank
