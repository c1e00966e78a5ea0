#pragma once

#include <optional>
#include <vector>

#include "filter/learn/likelihood/maximum_likelihood.hpp"
#include "filter/learn/refine/cross_validation.hpp"
#include "filter/learn/refine/refine.hpp"

namespace modebank {

/// The bank with R (diagonal) by maximum likelihood: the target is maximised over R and one factor on every Q (which
/// held the measurement noise before), theta and T as they are. Empty where the search's start is no better than the
/// bank or its end by no more than least_gain nats per sample: the data ask for no R. The IMM's likelihood is itself
/// approximate for R > 0.
std::optional<Bank> estimate_measurement_noise(const LikelihoodTarget& target, const Bank& bank,
                                               const RefineTuning& tuning);

/// The prior once the states count as unknown: that of the fit with states measured exactly, but Q as if one more
/// transition of the modes' own harmonic mean covariance in `start` was seen. The global residual covariance, which
/// holds what the modes differ in, would outweigh the data of modes that differ much. A harmonic mean is at most a few
/// times the least Q, so no mode is drawn up by more than about its share of one transition.
SwitchingPrior prior_with_states_unknown(const SwitchingPrior& exact, const Bank& start, const RefineTuning& tuning);

/// A fit that took measurement noise into account.
struct MeasuredBank {
  Bank bank;
  MeasurementStage stage;
  SwitchingPrior prior;
  bool R_estimated = false;
};

/// Where R is more than nothing (by estimate_measurement_noise in the filter that will run the bank, or as given), the
/// fit goes on with the states unknown, theta, Q, R and T together, to the maximum of the filter's likelihood; that is
/// kept if it pays on the runs left out, each scored by a fit that went on
/// from the fit to the others.
/// `of_splits`: the chosen fit of every split of the cross-validation.
MeasuredBank fit_with_measurement_noise(const RefineInput& in, const CrossValidation& validation,
                                        const std::vector<Bank>& of_splits, const SwitchingPrior& prior,
                                        const Bank& bank);

}  // namespace modebank
