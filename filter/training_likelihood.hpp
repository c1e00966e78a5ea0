#pragma once

#include "filter/bank.hpp"
#include "filter/evaluate.hpp"
#include "ident/trajectory.hpp"

namespace modebank {

/// Log-likelihood of all training runs, each from its second sample; runs in parallel, over lanes where log_likelihoods
/// takes them and over threads, summed in an order of their own.
double training_log_likelihood(const Bank& bank, const Recording& recording, const FilterOptions& options);

}  // namespace modebank
