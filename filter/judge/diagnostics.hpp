#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "filter/judge/evaluate.hpp"
#include "filter/judge/statistics.hpp"
#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"
#include "modebank/base/names.hpp"

/// Whether the uncertainty that a filter states is right.
namespace modebank {

/// Verdict about a filter's stated uncertainty, from the share of samples outside its 95 % band. If the model is
/// correct, 5 % lie outside.
/// - overconfident: more than 6 % lie outside, and more than 5 % with 99 % confidence.
/// - underconfident: fewer than 2.5 % outside, fewer than 5 % with 99 % confidence. Or fewer than 5 % outside, and more
///   than 4 % in the central band that should hold 2.5 % (too_close), with 95 % confidence.
/// - calibrated: 2.5 to 7.5 % lie outside, 1 to 4 % lie too close, and neither interval contains its whole band. The
///   mean NIS per signal lies in 0.75 to 1.3, and the lag-1 autocorrelation of each signal's z within +- 0.2. At each
///   of these limits a prediction loses 0.02 nats.
/// - undecided: all other cases, such as a few hundred samples.
/// Where neither of the first two holds, a mean NIS decides that lies outside the 99 % interval for a correct model,
/// and a tenth off; but only if every prediction is one Gaussian of known variance: else the NIS is not chi-square.
///
/// Autocorrelated samples count as fewer independent ones, by the longer of two autocorrelation times: of the band's
/// misses, and of the sizes of all samples, because short runs have few misses.
enum class Calibration { undecided, calibrated, overconfident, underconfident };

/// The number that decides a verdict. none: every number passes (calibrated). band: share inside the 95 % band. close:
/// share near the middle of the band. nis: mean NIS. pattern: lag-1 autocorrelation. few_samples: an interval is wider
/// than the calibrated band.
enum class CalibrationReason { none, band, close, nis, pattern, few_samples };

template <>
struct EnumNames<Calibration> {
  static constexpr Names<4> values{"undecided", "calibrated", "overconfident", "underconfident"};
};
template <>
struct EnumNames<CalibrationReason> {
  static constexpr Names<6> values{"none", "band", "close", "NIS", "pattern", "few samples"};
};

/// Limits for `calibrated`: share of signals outside the deciding band, and share of signals too close to the middle;
/// mean NIS per signal, and lag-1 autocorrelation of z.
inline constexpr double least_outside = 0.025, largest_outside = 0.075, least_close = 0.01, largest_close = 0.04;
inline constexpr double least_nis = 0.75, most_nis = 1.3, largest_correlation = 0.2;
inline constexpr double nis_tolerance = 0.1;  ///< tolerated relative deviation of the mean NIS of single Gaussians

/// One row of /evaluation/diagnostics: a filter, or one of its modes, on the pooled runs of a role. A mode is judged on
/// those samples where it was the most probable mode before the measurement; these are calibrated, too, because the
/// transform is uniform given all earlier information (Rosenblatt 1952; Diebold, Gunther & Tay 1998). Intervals have
/// 95 % confidence (Clopper & Pearson 1934) and do not include the error of a learned filter. NaN means unknown.
struct DiagnosticsRow {
  std::string filter;
  Role role = Role::train;
  Eigen::Index mode = -1;    ///< mode; -1 for the whole filter
  Eigen::Index samples = 0;  ///< scored samples
  double usage = 0.0;        ///< mean probability after the measurement of the mode, or of the most probable mode
  double entropy = 0.0;      ///< mean entropy of the probabilities after the measurement, divided by log K; 0 for K = 1
  double dwell = 0.0;  ///< mean stay in a mode along viterbi_mode (without it, along the most probable modes) [samples]
  double dwell_model = 0.0;  ///< 1 / (1 - T_jj), the mean stay by the transition matrix; NaN for the whole filter

  // Share of the signals inside the central bands, with intervals that allow for autocorrelation.
  double coverage_50 = 0.0, coverage_50_lower = 0.0, coverage_50_upper = 0.0;
  double coverage_90 = 0.0, coverage_90_lower = 0.0, coverage_90_upper = 0.0;
  double coverage_95 = 0.0, coverage_95_lower = 0.0, coverage_95_upper = 0.0;
  double coverage_99 = 0.0, coverage_99_lower = 0.0, coverage_99_upper = 0.0;
  double too_far = 0.0, too_far_lower = 0.0, too_far_upper = 0.0;        ///< share of z^2 above its 97.5 % quantile
  double too_close = 0.0, too_close_lower = 0.0, too_close_upper = 0.0;  ///< share of z^2 below its 2.5 % quantile
  double nis_mean = 0.0;            ///< SquaredDistances::mean of the NIS; n_y is expected for a correct model
  double nees_mean = 0.0;           ///< NEES of the states after the measurement that have noise, if the truth is known
  Eigen::VectorXd state_rmse = {};  ///< n_y, RMSE of the state against the true state; NaN if the true state is unknown
  double whiteness_p = 0.0;         ///< p value of Ljung & Box's test, as in the summary
  double autocorrelation = 0.0;     ///< largest autocorrelation of z by absolute value; 0 for a mode
  Eigen::Index autocorrelation_lag = 0;
  Calibration verdict = Calibration::undecided;
  CalibrationReason reason = CalibrationReason::few_samples;  ///< what decided the verdict
  std::string flags = {};                                     ///< remarkable facts, separated by "; "
};

/// Rows of one filter on the runs of a role, which alone need an evaluation: the whole filter, then each mode if there
/// are several. `chi_square_nis`: whether every prediction is one Gaussian of known variance.
std::vector<DiagnosticsRow> diagnose(const std::string& filter, Role role, const Bank& bank, bool chi_square_nis,
                                     const std::vector<Trajectory>& runs, const std::vector<RunEvaluation>& evaluations,
                                     const std::vector<RunScores>& scores);

/// Whether earlier errors predict a filter's errors: the errors are not white (Ljung & Box), and at least a hundredth
/// of their variance is predictable; or the verdict says so.
bool errors_follow_a_pattern(const DiagnosticsRow& row);

}  // namespace modebank
