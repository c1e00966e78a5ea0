#pragma once

#include <vector>

#include "ident/window_context.hpp"

namespace modebank {

/// Indices of the windows that an audit of M checks, increasing: one at random in each of min(M, max(200, M / 1000))
/// strata.
std::vector<Index> audited_windows(Index M, std::uint64_t seed);

/// How far a window's cost is above Ceres', relative; differences of costs below 1e-9 per sample (residuals of some
/// 1e-5 of their standard deviation) are rounding errors.
double relative_cost_above(double cost, double ceres_cost, Index samples);

/// One window solved again through Ceres.
struct AuditedWindow {
  bool compared = false;
  double cost = 0.0;       ///< of the batch solution above that of Ceres, relative; negative where it is lower
  double parameter = 0.0;  ///< largest difference of a parameter, in its standard error
  LocalModel ceres;
};

/// Compares `fit` with Ceres' answer by the objective that Ceres has minimised.
AuditedWindow audit_window(const WindowContext& context, const Window& window, const ParameterPrior* prior,
                           const LocalModel& fit);

/// Adds a compared window; returns whether the batch solution is above tolerance and Ceres' has to take its place.
bool add_to_audit(const AuditedWindow& window, WindowAudit& audit);

}  // namespace modebank
