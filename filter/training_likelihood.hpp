#pragma once

#include "filter/bank.hpp"
#include "filter/evaluate.hpp"
#include "ident/trajectory.hpp"

namespace modebank {

/// Log-likelihood of all training runs, each from its second sample; runs in parallel, summed in their order.
double training_log_likelihood(const Bank& bank, const Recording& recording, const FilterOptions& options);

}  // namespace modebank
