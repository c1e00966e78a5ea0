#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "modebank/base/recording.hpp"
#include "modebank/filter/bank.hpp"
#include "modebank/filter/screened_mode.hpp"
#include "modebank/ident/motion_model.hpp"
#include "modebank/ident/window_audit.hpp"
#include "modebank/learn/options.hpp"
#include "modebank/learn/results.hpp"
#include "modebank/mixture/mixture.hpp"

namespace modebank::learn {

/// What is known of the numbers of a bank of K modes, each a linear model with p parameters theta (A row by row, B and
/// c of each measured state in turn; of a motion model the parameters of its linearisation).
struct Uncertainty {
  std::vector<std::string> parameter_names;         ///< p
  Matrix theta;                                     ///< p x K
  Matrix theta_standard_error;                      ///< p x K
  std::vector<Matrix> Q_standard_error;             ///< K of n x n; empty unless refined
  Matrix R_standard_error;                          ///< n_y x n_y; empty unless R was estimated with the bank
  Matrix transition_standard_error;                 ///< K x K; empty unless refined
  std::vector<std::string> motion_parameter_names;  ///< of a motion model; empty for linear ones
  Matrix motion_theta;                              ///< of a motion model, one mode per column
  Matrix motion_theta_standard_error;               ///< the same
};

/// How the bank came about from M windows.
struct Origin {
  WindowAudit windows;                       ///< who solved how many windows to what tolerance
  std::vector<std::string> features;         ///< F, what of a window was clustered
  mixture::Mixture mixture;                  ///< of the windows
  std::vector<Candidate> candidates;         ///< that it was chosen from
  std::vector<int> labels;                   ///< M in the order of ident::fit_windows: component; -1: none
  std::vector<ScreenedMode> screened;        ///< components and fits that are no mode of the bank
  std::vector<RefineCandidate> refinements;  ///< of refinement: starts and how they scored; empty without
  std::vector<double> objective;             ///< of refinement: penalised log-likelihood before each iteration
  MeasurementStage measurement;              ///< of refinement: how it went on with measurement noise
};

/// A bank, ready for BankFilter, and what is known of it.
struct Learned {
  filter::Bank bank;                     ///< the modes
  filter::Bank baseline;                 ///< the competitor to beat: one Kalman filter of all runs
  double log_likelihood = 0.0;           ///< of the bank in LearnOptions::filter on the runs learned from [nats]
  double baseline_log_likelihood = 0.0;  ///< of the baseline on the same samples [nats]
  Uncertainty uncertainty;               ///< of the bank
  Origin origin;                         ///< of the bank
};

/// Fits windows, clusters them and learns a bank from the runs that are not held out, on all cores: the numbers are
/// those of `modebank run` for the same options and the same for any number of threads. Log-likelihoods are from each
/// run's second sample. Throws std::invalid_argument for an option out of range and for runs
/// whose sizes do not fit, DataError (modebank/base/error.hpp) where nothing can be learned from these runs.
Learned learn_bank(const RecordedRuns& runs, const LearnOptions& options = {});

/// The same for a motion model of one's own; options.window.model does not count. Refinement is for linear models only.
Learned learn_bank(const RecordedRuns& runs, const LearnOptions& options, const MotionModel& model);

}  // namespace modebank::learn
