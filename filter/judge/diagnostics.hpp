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
/// - underconfident: fewer than 2.5 % lie outside, and fewer than 5 % with 99 % confidence. Or fewer than 5 % lie
///   outside, and more than 4 % lie in the central band that should hold 2.5 % (too_close), with 95 % confidence.
/// - calibrated: 2.5 to 7.5 % lie outside, 1 to 4 % lie too close, and neither interval contains its whole band. The
///   mean NIS per signal lies in 0.75 to 1.3, and the lag-1 autocorrelation of each signal's z within +- 0.2. At each
///   of these limits a prediction loses 0.02 nats.
/// - undecided: all other cases, such as a few hundred samples.
/// If the filter is neither overconfident nor underconfident by these rules, the mean NIS decides. It must lie outside
/// the 99 % interval for a correct model and differ from the expected mean by more than a tenth. This rule holds only
/// if every prediction is one Gaussian of known variance. Otherwise (mixture, running noise) the NIS is not chi-square
/// and decides nothing here.
///
/// Autocorrelated samples count as fewer independent samples. Their number follows from an autocorrelation time with a
/// margin for its own error. Two times are computed: from the band's misses, and from the sizes of all samples. The
/// second is needed because short runs have few misses. The longer time is used.
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

struct Verdict {
  Calibration calibration = Calibration::undecided;
  CalibrationReason reason = CalibrationReason::few_samples;
};

/// Limits for `calibrated`: share of signals outside the deciding band, and share of signals too close to the middle.
inline constexpr double least_outside = 0.025, largest_outside = 0.075, least_close = 0.01, largest_close = 0.04;
/// Tolerated deviation of the mean NIS of single Gaussian predictions, as a share of its expected value. It corresponds
/// to a twentieth of the band's width.
inline constexpr double nis_tolerance = 0.1;
/// Limits for `calibrated`: mean NIS per signal, and lag-1 autocorrelation of z.
inline constexpr double least_nis = 0.75, most_nis = 1.3, largest_correlation = 0.2;

/// 1 where a signal is a hit, else 0; run by run, in time order. An element has one byte, because each sample has six
/// elements.
using HitsByRun = std::vector<std::vector<char>>;
SeriesByRun as_numbers(const HitsByRun& hits);

/// Counts over the scored signals of some samples, from which a verdict follows.
struct BandCounts {
  std::array<HitsByRun, coverage_levels.size()> outside;  ///< 1 where a signal lies outside the band, else 0
  HitsByRun far, close;         ///< 1 where z^2 lies above the 97.5 % or below the 2.5 % quantile of chi-square(1)
  SeriesByRun sizes;            ///< sizes of the same signals; a size increases with the distance of the PIT from 1/2
  SquaredDistances nis;         ///< NIS of each sample
  double nis_degrees = 1.0;     ///< n_y
  bool chi_square_nis = false;  ///< whether the NIS is chi-square for a correct model
  double correlation = 0.0;     ///< largest lag-1 autocorrelation of a signal's z by absolute value; 0 if unknown

  /// Starts the next run, with memory for all its samples: growing series would take up to twice the memory.
  void begin_run(const RunEvaluation& run);
  /// Counts sample k of the run.
  void add(const RunEvaluation& run, const RunScores& scores, Eigen::Index k);
};
/// Share of hits; NaN without signals.
double share_of(const HitsByRun& hits);

/// Autocorrelation time of hits, from the sizes of all signals, with a margin. NaN without signals.
double time_by_sizes(const SeriesByRun& sizes);
/// Interval of a fraction of hits, for the effective number of independent samples. `time`: from time_by_sizes.
Interval fraction_interval(const SeriesByRun& hits, double time, double level = 0.95);

/// The verdict for these counts, and why. `time`: from time_by_sizes.
Verdict verdict_of(const BandCounts& counts, double time);

/// One row of /evaluation/diagnostics: a filter, or one of its modes, on the pooled runs of a role. A mode is judged on
/// those samples where it was the most probable mode before the measurement. If the model is correct, these samples are
/// calibrated, too, because the transform is uniform given all earlier information (Rosenblatt 1952; Diebold, Gunther &
/// Tay 1998). Intervals have 95 % confidence. Those of fractions follow Clopper & Pearson (1934), with the effective
/// number of independent samples. The intervals hold for a correct model; they do not include the error of a learned
/// filter. NaN means unknown.
struct DiagnosticsRow {
  std::string filter;
  Role role = Role::train;
  Eigen::Index mode = -1;    ///< mode; -1 for the whole filter
  Eigen::Index samples = 0;  ///< scored samples
  double usage = 0.0;        ///< mean probability of the mode after the measurement; for the whole filter, of its most
                             ///< probable mode
  double entropy = 0.0;      ///< mean entropy of the probabilities after the measurement, divided by log K; 0 for K = 1
  double dwell = 0.0;  ///< mean stay in a mode along viterbi_mode (without it, along the most probable modes) [samples]
  double dwell_model = 0.0;  ///< 1 / (1 - T_jj), the mean stay according to the transition matrix; NaN for the whole
                             ///< filter

  // Share of the signals inside the central bands, with intervals that allow for autocorrelation.
  double coverage_50 = 0.0, coverage_50_lower = 0.0, coverage_50_upper = 0.0;
  double coverage_90 = 0.0, coverage_90_lower = 0.0, coverage_90_upper = 0.0;
  double coverage_95 = 0.0, coverage_95_lower = 0.0, coverage_95_upper = 0.0;
  double coverage_99 = 0.0, coverage_99_lower = 0.0, coverage_99_upper = 0.0;
  double too_far = 0.0, too_far_lower = 0.0, too_far_upper = 0.0;        ///< share of z^2 above its 97.5 % quantile
  double too_close = 0.0, too_close_lower = 0.0, too_close_upper = 0.0;  ///< share of z^2 below its 2.5 % quantile
  double nis_mean = 0.0;         ///< `mean_distance` of the NIS; n_y is expected for a correct model
  double nees_mean = 0.0;        ///< NEES of the state after the measurement, if the true state is known. NaN if R is
                                 ///< negligible, because the state then equals the measurement
  Eigen::VectorXd state_rmse;    ///< n_y, RMSE of the state against the true state; NaN if the true state is unknown
  double whiteness_p = 0.0;      ///< p value of Ljung & Box's test, as in the summary
  double autocorrelation = 0.0;  ///< largest autocorrelation of z by absolute value, found at autocorrelation_lag; 0
                                 ///< for a mode
  Eigen::Index autocorrelation_lag = 0;
  Calibration verdict = Calibration::undecided;
  CalibrationReason reason = CalibrationReason::few_samples;  ///< what decided the verdict
  std::string flags;                                          ///< remarkable facts, separated by "; "
};

/// Rows of one filter on the runs of a role: the whole filter, then each mode if there are several. Without runs there
/// are no rows. Only the runs of this role need an evaluation. `chi_square_nis`: whether every prediction is
/// one Gaussian of known variance. `scores`: scores of the evaluations (score_runs).
std::vector<DiagnosticsRow> diagnose(const std::string& filter, Role role, const Bank& bank, bool chi_square_nis,
                                     const std::vector<Trajectory>& runs, const std::vector<RunEvaluation>& evaluations,
                                     const std::vector<RunScores>& scores);

/// Whether earlier errors predict a filter's errors: the errors are not white (Ljung & Box), and at least a hundredth
/// of their variance is predictable; or the verdict says so.
bool errors_follow_a_pattern(const DiagnosticsRow& row);

}  // namespace modebank
