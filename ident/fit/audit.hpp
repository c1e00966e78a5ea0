#pragma once

#include <vector>

#include "ident/fit/window_fitter.hpp"

namespace modebank {

/// Indices of the windows that an audit of M checks, increasing: one at random in each of min(M, max(200, M / 1000))
/// strata.
std::vector<Index> audited_windows(Index M, std::uint64_t seed);

/// What one window says of the batch solver's theta and of that of Ceres alone (minimise_by_ceres_alone), both judged
/// by the objective that Ceres has minimised.
struct AuditedWindow {
  bool compared = false;
  double cost = 0.0;  ///< of the batch solution above that of Ceres, relative; negative where it is lower. Differences
                      ///< below 1e-9 per sample (residuals of some 1e-5 of their standard deviation) are rounding
  double gradient = 0.0;        ///< scaled_gradient in the batch solution
  double ceres_gradient = 0.0;  ///< in Ceres'
  double parameter = 0.0;  ///< largest difference of a parameter, in its standard error; says nothing of who is right
};

AuditedWindow audit_window(const LinearWindows& windows, const Window& window, const ParameterPrior* prior,
                           const LocalModel& fit);

/// Adds a compared window; returns whether the batch solution is no minimum by its cost or its gradient, and has to be
/// replaced.
bool add_to_audit(const AuditedWindow& window, WindowAudit& audit);

}  // namespace modebank
