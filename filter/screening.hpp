#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "filter/bank.hpp"
#include "filter/pooled_modes.hpp"

namespace modebank {

/// Slack above 1 for the spectral radius of I + A: an integrator (A = 0) must survive rounding.
inline constexpr double spectral_radius_slack = 1e-9;

/// Largest absolute eigenvalue of I + A; infinite when A is not finite.
double spectral_radius(const LinearModel& model);

/// Why a mode cannot serve in a bank: "starved" (fewer effective transitions than regressors + 1), "unstable"
/// (spectral radius of I + A above 1), or empty when it can.
std::string screening_reason(const LinearStructure& structure, const ModeEstimate& mode);

/// "component 2 unstable (spectral radius 1.31), ..." for messages.
std::string describe(const std::vector<ScreenedMode>& screened);

}  // namespace modebank
