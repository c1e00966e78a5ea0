#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "modebank/base/recording.hpp"
#include "modebank/filter/bank.hpp"
#include "modebank/ident/motion_model.hpp"
#include "modebank/learn/options.hpp"
#include "modebank/learn/results.hpp"
#include "modebank/mixture/mixture.hpp"

namespace modebank::learn {

/// Parameters and standard errors of a bank of K modes, with p parameters theta each: A (row by row), B and c of each
/// measured state in turn. For a motion model, theta are the parameters of its linearisation.
struct Uncertainty {
  std::vector<std::string> parameter_names;         ///< p
  Matrix theta;                                     ///< p x K
  Matrix theta_standard_error;                      ///< p x K
  std::vector<Matrix> Q_standard_error;             ///< K standard errors of Q, n x n each; empty without refinement
  Matrix R_standard_error;                          ///< n_y x n_y; empty unless R was estimated with the bank
  Matrix transition_standard_error;                 ///< K x K; empty without refinement
  std::vector<std::string> motion_parameter_names;  ///< parameters of a motion model; empty for linear models
  Matrix motion_theta;                              ///< parameters of a motion model, one mode per column
  Matrix motion_theta_standard_error;               ///< of the same shape
};

/// How a bank was learned.
struct Origin {
  std::vector<std::string> features;         ///< F, clustered features of a window
  mixture::Mixture mixture;                  ///< mixture of the windows
  std::vector<Candidate> candidates;         ///< candidates for the mixture
  std::vector<int> labels;                   ///< M, component of each window of ident::fit_windows; -1: none
  std::vector<ScreenedMode> screened;        ///< components and fits that did not become modes
  std::vector<RefineCandidate> refinements;  ///< starts of the refinement and their scores; empty without refinement
  std::vector<double> objective;             ///< penalised log-likelihood before each iteration of the refinement
  MeasurementStage measurement;              ///< results of the refinement with measurement noise
};

/// A bank, ready for BankFilter, with its uncertainty and origin.
struct Learned {
  filter::Bank bank;                     ///< the modes
  filter::Bank baseline;                 ///< reference competitor: one Kalman filter for all runs
  double log_likelihood = 0.0;           ///< of the bank with LearnOptions::filter on the training runs [nats]
  double baseline_log_likelihood = 0.0;  ///< of the baseline on the same samples [nats]
  Uncertainty uncertainty;               ///< of the bank
  Origin origin;                         ///< of the bank
};

/// Learns a bank from the training runs, on all cores. The results equal those of `modebank run` for the same options,
/// with any number of threads. Log-likelihoods begin with each run's second sample. Throws std::invalid_argument for an
/// option out of range and for runs whose sizes do not fit, DataError (modebank/base/error.hpp) if nothing can be
/// learned.
Learned learn_bank(const RecordedRuns& runs, const LearnOptions& options = {});

/// Like `learn_bank`, but for the caller's own motion model; options.window.model is ignored. Refinement is for linear
/// models only.
Learned learn_bank(const RecordedRuns& runs, const LearnOptions& options, const MotionModel& model);

}  // namespace modebank::learn
