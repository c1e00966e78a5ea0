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

/// What a search for R found.
struct MeasurementNoise {
  std::optional<Bank> bank;  ///< with R, and less Q; empty: the data ask for none, or every start failed
  Index starts = 0;
  Index failed_starts = 0;  ///< where the likelihood is no number, or no step from there raised it
};

/// The bank with R (diagonal) by maximum likelihood: the target is maximised over R and one factor on every Q (which
/// held the measurement noise before), theta and T as they are, from several shares of Q; the best end counts. No bank
/// where that is no more than least_gain nats per sample better than the bank without R: the data ask for none. The
/// IMM's likelihood is itself approximate for R > 0.
MeasurementNoise estimate_measurement_noise(const LikelihoodTarget& target, const Bank& bank,
                                            const RefineTuning& tuning);

/// The prior once the states count as unknown: that of the fit with states measured exactly, but Q as if one more
/// transition of the modes' own harmonic mean covariance in `start` was seen. The global residual covariance, which
/// holds what the modes differ in, would outweigh the data of modes that differ much. A harmonic mean is at most a few
/// times the least Q, so no mode is drawn up by more than about its share of one transition.
SwitchingPrior prior_with_states_unknown(const SwitchingPrior& exact, const Bank& start, const RefineTuning& tuning);

/// Where R is more than nothing (by estimate_measurement_noise in the filter that will run the bank, unless it costs
/// the runs left out more than least_gain, or as given), the fit goes on with the states unknown, theta, Q, R and T
/// together, to the maximum of the filter's likelihood; that is kept if it pays on the runs left out, each scored by a
/// fit that has not seen it: its R, its prior and all else are those of the other runs. Rounded states are unknown
/// whatever R is: their fit goes on so in any case, and R is looked for afterwards, what rounding alone explains being
/// in the likelihood by then. R is not looked for beside more than eight lags of the state.
/// `exact`: with its bank of exact states and that bank's prior. `stage` says what was found.
Fit fit_with_measurement_noise(const RefineInput& in, const CrossValidation& validation, const Fit& exact,
                               MeasurementStage& stage);

}  // namespace modebank
