#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "filter/judge/calibration.hpp"
#include "filter/judge/evaluate.hpp"
#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"

namespace modebank {

/// One row of /evaluation/diagnostics: a filter, or one of its modes, on the pooled runs of a role. A mode is judged on
/// those samples where it was the most probable mode before the measurement. If the model is correct, these samples are
/// calibrated, too, because the transform is uniform given all earlier information (Rosenblatt 1952; Diebold, Gunther &
/// Tay 1998). Intervals have 95 % confidence. Those of fractions follow Clopper & Pearson (1934), with the effective
/// number of independent samples (calibration.hpp).
/// The intervals hold for a correct model; they do not include the error of a learned filter. NaN means unknown.
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
