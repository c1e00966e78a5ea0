#pragma once

#include "ident/data/trajectory.hpp"
#include "ident/fit/options.hpp"
#include "ident/lag/structure.hpp"

namespace modebank {

/// Finds the lags and the delay of one linear model of the training runs (method: section 2a, item 2).
///
/// Structures have 1 to 12 state lags, 1 to 12 input lags and a delay of least_delays to 12 samples. They are compared
/// on the same transitions, by their log score on training runs that are left out (below six runs: stretches). If the
/// best structure lies at an end of a range, the range grows, to 30 at most. The search changes one number at a time,
/// from several starts, by least squares. The ten best structures are fitted again with the loss and scale of `window`.
///
/// Chooses the smallest structure within one standard error, or within 0.001 nats, of the best. A delay of 0 must gain
/// 0.02 nats over the best longer delay. The reason: an input that reacts to the state within its sample also favours a
/// delay of 0.
///
/// Numbers that are not searched stay as in `window`. Data with little information never cause an exception. If lags
/// would cost more than a quarter of the transitions, ranges shrink and the result has a remark. The result is the same
/// for any number of threads.
FoundStructure find_structure(const Recording& recording, const FitOptions& window, const SearchedLags& searched);

/// Least delay of each input (m) in searches: 1, or 0 for an input that is held, that is, repeats in over half of the
/// samples. An input that moves in every sample may be computed from the state of the same sample, and data of one
/// closed loop cannot tell that from an effect without delay.
std::vector<Index> least_delays(const Recording& recording);

}  // namespace modebank
