#pragma once

#include "ident/lag/objective.hpp"

namespace modebank {

/// Variance of the lag at the optimum, by a Gauss-Newton sandwich. NaN if the data do not determine it.
double lag_variance_s2(const LagObjective& objective, const LagPoint& point);

}  // namespace modebank
