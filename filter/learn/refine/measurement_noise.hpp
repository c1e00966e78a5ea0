#pragma once

#include <array>
#include <optional>
#include <vector>

#include "filter/learn/refine/cross_validation.hpp"

namespace modebank {

/// Starting values of the search for R, as shares of the mean Q. They are below a half, because R enters Q twice.
inline constexpr std::array R_start_shares{0.05, 0.45};

/// Result of a search for R.
struct MeasurementNoise {
  std::optional<Bank> bank;   ///< bank with R; empty if R does not gain, or if every start failed
  SwitchingPrior prior = {};  ///< the prior with which the bank is most likely
  Index failed_starts = 0;    ///< number of starts that failed: the likelihood is not finite, or no step raised it
  Index iterations = 0;       ///< of theta, Q, R and T together
  MeasuredFit end = MeasuredFit::none;
};

/// The bank whose theta, Q, R (diagonal) and T together maximise the filter's likelihood of these runs. The search
/// moves R and one factor on every Q first. If they gain nothing, theta moves, too: with the theta of exact states,
/// which takes in the noise, R = 0 may be most likely. Each start puts one of the `shares` of the mean Q into R; the
/// first is that of the search with theta. A start is tried if a Newton step from it is expected to rise far enough.
/// For a filter of more than four states only the likelier start is, and theta only with few coordinates. Empty unless
/// the search gains more than least_gain nats per sample over the bank. For several modes and R > 0 the likelihood of
/// an IMM is itself approximate. `exact`: the prior of exact states.
MeasurementNoise find_measurement_noise(const RefineInput& in, const Recording& recording,
                                        const TrainingTransitions& transitions, const SwitchingPrior& exact,
                                        const Bank& bank, const std::array<double, 2>& shares);

/// Whether at least half of the banks have an R of at least a tenth of this one (traces).
bool mostly_have(const std::vector<Bank>& banks, const Eigen::MatrixXd& R);

/// Continues the fit with unknown states if R is not negligible.
/// - A given R, or that of rounding: theta, Q and T maximise the filter's likelihood.
/// - R is searched (find_measurement_noise), for rounded states beside the rounding. With more than eight state lags or
///   a noise factor, it is not.
/// Either is taken unless left-out runs lose more than least_gain, and R only if the splits mostly_have it. Each run is
/// scored by a fit whose R, prior and other parameters come from the other runs. `exact`: the fit with exact states,
/// with its bank and prior. `stage` records the result.
Fit fit_with_measurement_noise(const RefineInput& in, const CrossValidation& validation, const Fit& exact,
                               MeasurementStage& stage);

}  // namespace modebank
