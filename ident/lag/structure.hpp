#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "modebank/ident/input_delays.hpp"

namespace modebank {

/// Largest number of lags that a search tries first.
inline constexpr std::ptrdiff_t usual_lags = 12;

/// Numbers of state lags and input lags, and the delay.
using Lags = std::array<std::ptrdiff_t, 3>;

/// Flags the numbers of lags that are searched. FitOptions give the values of all other numbers.
struct SearchedLags {
  bool state = false;               ///< state_lags
  bool input = false;               ///< input_lags
  bool delay = false;               ///< input_delay
  std::ptrdiff_t most_samples = 0;  ///< largest number of samples that a run may need before its first prediction; 0
                                    ///< means no limit
  bool any() const { return state || input || delay; }
};

/// Lags of a stage, with the delay of each input.
struct StageLags {
  std::ptrdiff_t state_lags = 1;
  std::ptrdiff_t input_lags = 1;
  InputDelays input_delay = 1;
};

/// Lags of y[k] = sum A_j y[k-j] + sum b_ij u_i[k-d_i-j] + c + e[k] + sum C_j e[k-j]. j counts from 0 for inputs, from
/// 1 for states and noise. In differences, y and u are differences of successive samples, and c is absent.
struct ArmaxOrder {
  bool differences = false;
  std::ptrdiff_t state_lags = 1, input_lags = 1, noise_lags = 1;
  bool intercept = true;  ///< whether levels have the constant
  bool has_constant() const { return intercept && !differences; }
  bool operator==(const ArmaxOrder&) const = default;
};

/// A structure with the delay of each input.
struct ArmaxStructure {
  ArmaxOrder order;
  std::vector<std::ptrdiff_t> delays;  ///< m [samples]
  bool operator==(const ArmaxStructure&) const = default;
};

/// Scores of one structure (lags and delay) on training runs that were left out.
struct StructureScore {
  std::ptrdiff_t state_lags = 1;
  std::ptrdiff_t input_lags = 1;
  std::ptrdiff_t input_delay = 1;    ///< the latest of all inputs
  double log_score = 0.0;            ///< log score of all states together [nats/sample]
  double loss = 0.0;                 ///< loss relative to the best structure of the table [nats/sample]
  double loss_standard_error = 0.0;  ///< standard error of the loss, over runs or stretches [nats/sample]
  Eigen::VectorXd rmse = {};         ///< n, RMSE of the one-step prediction [state unit]
  bool chosen = false;               ///< whether this structure was chosen for windows, mixture and bank
  bool linear = false;  ///< whether this structure was chosen for the single linear models (baseline, noise_only) and
                        ///< the search for terms
  bool one_motion = false;  ///< whether this structure was chosen for one motion whose noise switches
  bool drifting = false;    ///< whether this structure was chosen for one motion whose coefficients drift

  /// Causal log score of the training runs with drifting coefficients [nats/sample]; NaN if it was not computed.
  double drifting_score = std::numeric_limits<double>::quiet_NaN();
  /// Log score of a few modes and of one motion with switching noise, on training runs that were left out
  /// [nats/sample]. NaN if it was not computed.
  double modes_score = std::numeric_limits<double>::quiet_NaN();
  double one_motion_score = std::numeric_limits<double>::quiet_NaN();
  std::ptrdiff_t noise_lags = 0;  ///< lags of C of an ARMAX; 0 for an ARX
  bool differences = false;       ///< whether the model is one of differences between samples
};

/// The lags of windows, mixture and bank, the lags of other stages (in the table), the delays, and the evidence for the
/// choice.
struct FoundStructure {
  std::ptrdiff_t state_lags = 1;
  std::ptrdiff_t input_lags = 1;
  InputDelays input_delay = 1;              ///< of the single linear model
  std::ptrdiff_t samples = 0;               ///< number of samples that every structure predicted
  std::ptrdiff_t parts = 0;                 ///< number of runs or stretches over which standard errors are computed
  bool by_runs = false;                     ///< true: the parts are whole runs; false: stretches of runs
  std::ptrdiff_t structures = 0;            ///< number of structures compared
  std::ptrdiff_t noise_lags = 0;            ///< of the single linear model; 0 for an ARX
  bool differences = false;                 ///< whether that model is one of differences
  bool noisy_sensor = false;                ///< whether the search found more sensor noise than a tenth of Q
  std::string remark = {};                  ///< reason why the search did not use its full range; empty if it did
  std::vector<StructureScore> scores = {};  ///< scores of the finalists, in decreasing order

  /// Those of the single linear model if its latest is that of the row; otherwise that of the row for all inputs.
  InputDelays delays_of(const StructureScore& row) const { return input_delay.with_latest(row.input_delay); }
  /// The delays of windows, mixture and bank.
  InputDelays delays_of_modes() const {
    const auto row = std::ranges::find_if(scores, &StructureScore::chosen);
    return row == scores.end() ? input_delay : delays_of(*row);
  }
};

}  // namespace modebank
