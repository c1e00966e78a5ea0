#pragma once

#include <vector>

#include "ident/fit/window_fitter.hpp"

namespace modebank {

/// Indices of the audited windows of M, increasing: one random window from each of min(M, max(200, M / 1000)) strata.
std::vector<Index> audited_windows(Index M, std::uint64_t seed);

/// Comparison of the batch solver's theta with the theta of Ceres alone (minimise_by_ceres_alone) in one window. Ceres'
/// objective judges both.
struct AuditedWindow {
  bool compared = false;
  double cost = 0.0;  ///< relative excess of the batch solution's cost over the cost of Ceres' solution; negative if
                      ///< the batch solution is better. Differences below 1e-9 per sample (residuals of about 1e-5
                      ///< standard deviations) are rounding errors
  double gradient = 0.0;        ///< scaled_gradient at the batch solution
  double ceres_gradient = 0.0;  ///< scaled_gradient at Ceres' solution
  double parameter = 0.0;  ///< largest difference of a parameter, in standard errors; does not show which solver is
                           ///< better
};

AuditedWindow audit_window(const LinearWindows& windows, const Window& window, const ParameterPrior* prior,
                           const LocalModel& fit);

/// Adds a compared window. Returns true if the batch solution is not a minimum (by cost or gradient) and must be
/// replaced.
bool add_to_audit(const AuditedWindow& window, WindowAudit& audit);

}  // namespace modebank
