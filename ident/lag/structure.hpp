#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace modebank {

/// Largest number of lags that a search tries first.
inline constexpr std::ptrdiff_t usual_lags = 12;

/// State lags, input lags, delay.
using Lags = std::array<std::ptrdiff_t, 3>;

/// Numbers of lags that are searched. FitOptions give the others.
struct SearchedLags {
  bool state = false;               ///< state_lags
  bool input = false;               ///< input_lags
  bool delay = false;               ///< input_delay
  std::ptrdiff_t most_samples = 0;  ///< largest number of samples that a run may need before its first prediction; 0
                                    ///< means no limit
  bool any() const { return state || input || delay; }
};

/// Scores of one structure (lags and delay) on left-out training runs.
struct StructureScore {
  std::ptrdiff_t state_lags = 1;
  std::ptrdiff_t input_lags = 1;
  std::ptrdiff_t input_delay = 1;
  double log_score = 0.0;            ///< log score of all states together [nats/sample]
  double loss = 0.0;                 ///< loss against the best structure of the table [nats/sample]
  double loss_standard_error = 0.0;  ///< standard error over runs or stretches [nats/sample]
  Eigen::VectorXd rmse = {};         ///< n, RMSE of the one-step prediction [state unit]
  bool chosen = false;               ///< chosen for windows, mixture and bank
  bool linear = false;               ///< chosen for the single linear models (baseline, noise_only) and the search for
                                     ///< terms
  bool one_motion = false;           ///< chosen for one motion whose noise switches
  bool drifting = false;             ///< chosen for one motion whose coefficients drift

  /// Causal log score of the training runs with drifting coefficients [nats/sample]; NaN if it was not computed.
  double drifting_score = std::numeric_limits<double>::quiet_NaN();
  /// Log score of a few modes and of one motion with switching noise, on training runs that were left out
  /// [nats/sample]. NaN if it was not computed.
  double modes_score = std::numeric_limits<double>::quiet_NaN();
  double one_motion_score = std::numeric_limits<double>::quiet_NaN();
};

/// The lags and delay of windows, mixture and bank, those of other stages (in the table), and the evidence for the
/// choice.
struct FoundStructure {
  std::ptrdiff_t state_lags = 1;
  std::ptrdiff_t input_lags = 1;
  std::ptrdiff_t input_delay = 1;
  std::ptrdiff_t samples = 0;     ///< number of samples that every structure predicted
  std::ptrdiff_t parts = 0;       ///< number of runs or stretches over which standard errors are computed
  bool by_runs = false;           ///< whether parts are whole runs
  std::ptrdiff_t structures = 0;  ///< number of structures compared by least squares

  /// Largest |t| of past innovations in a regression of the inputs on their own lags. It is large if the inputs react
  /// to the states. NaN without inputs or with too few samples.
  double feedback_t = 0.0;
  double same_sample_t = 0.0;               ///< largest |t| of the innovation of the input's own sample
  std::string remark = {};                  ///< reason why the search could not use its full range; empty if it could
  std::vector<StructureScore> scores = {};  ///< scores of the finalists, the best first

  /// |t| above which the inputs are reported to react to past innovations.
  static constexpr double feedback_limit = 5.0;
  bool feedback() const { return feedback_t > feedback_limit; }
};

}  // namespace modebank
