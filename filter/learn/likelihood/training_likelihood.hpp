#pragma once

#include "filter/judge/run/evaluate.hpp"
#include "filter/judge/run/look_ahead.hpp"
#include "filter/step/bank.hpp"
#include "filter/step/likelihood_gradient.hpp"
#include "ident/data/trajectory.hpp"

namespace modebank {

/// Log-likelihood of all training runs [nats], each from its second sample, ignoring sample weights. Runs in parallel,
/// with a fixed order of summation. `look`: look-ahead score, which then replaces the log-likelihood.
double training_log_likelihood(const Bank& bank, const Recording& recording, const FilterOptions& options,
                               const LookAhead& look = {});

/// Like training_log_likelihood, but every sample's density is raised to the power of its weight, in units of
/// mean_training_weight.
double weighted_training_log_likelihood(const Bank& bank, const Recording& recording, const FilterOptions& options,
                                        const LookAhead& look = {});

/// The gradient of weighted_training_log_likelihood. Requires has_likelihood_gradient (filter/step).
BankGradient training_gradient(const Bank& bank, const Recording& recording, const FilterOptions& options);

/// Mean positive weight of the training samples; 1 without weights. Only ratios of weights matter.
double mean_training_weight(const Recording& recording);

}  // namespace modebank
