#pragma once

#include "filter/judge/run/evaluate.hpp"
#include "filter/judge/run/look_ahead.hpp"
#include "filter/step/bank.hpp"
#include "filter/step/likelihood_gradient.hpp"
#include "ident/data/trajectory.hpp"

namespace modebank {

/// Log-likelihood of all training runs [nats], each from its second sample. Runs in parallel, with a fixed order of
/// summation. `look`: look-ahead score, which then replaces the log-likelihood.
double training_log_likelihood(const Bank& bank, const Recording& recording, const FilterOptions& options,
                               const LookAhead& look = {});

/// The gradient of training_log_likelihood. Requires has_likelihood_gradient (filter/step).
BankGradient training_gradient(const Bank& bank, const Recording& recording, const FilterOptions& options);

}  // namespace modebank
