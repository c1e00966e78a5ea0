#pragma once

#include "ident/data/trajectory.hpp"
#include "ident/fit/options.hpp"
#include "ident/lag/structure.hpp"

namespace modebank {

/// The lags and the delay of one linear model of the training runs (method: section 2a, item 2). Structures of 1 to 12
/// state lags, 1 to 12 input lags and a delay of 0 to 12 samples are compared by the log score of training runs that
/// are left out (below six runs: of stretches), on the same transitions; where the best lies at an end, that end moves,
/// to 30 at most. The search goes by one number at a time, from several starts, with least squares. The ten best are
/// fitted by the loss and scale of `window`. The fewest lags within one standard error of the best are chosen, or
/// within 0.001 nats. A delay of 0 must gain 0.02 nats over the best longer one, since an input that answers to the
/// state within its sample looks the same.
///
/// Numbers that are not `searched` for stay as `window` has them. Never throws for data that determine little: ranges
/// become smaller where lags would cost more than a quarter of the transitions, and the result has a remark. The same
/// for any number of threads.
FoundStructure find_structure(const Recording& recording, const FitOptions& window, const SearchedLags& searched);

}  // namespace modebank
