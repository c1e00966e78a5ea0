#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace modebank {

/// Lags that a search tries first.
inline constexpr std::ptrdiff_t usual_lags = 12;

/// State lags, input lags, delay.
using Lags = std::array<std::ptrdiff_t, 3>;

/// Which numbers of a model with lags are searched for; the others are as FitOptions state them.
struct SearchedLags {
  bool state = false;               ///< state_lags
  bool input = false;               ///< input_lags
  bool delay = false;               ///< input_delay
  std::ptrdiff_t most_samples = 0;  ///< that a run may need before its first prediction; 0: any number
  bool any() const { return state || input || delay; }
};

/// How a model with these lags and this delay predicted training runs that were left out.
struct StructureScore {
  std::ptrdiff_t state_lags = 1;
  std::ptrdiff_t input_lags = 1;
  std::ptrdiff_t input_delay = 1;
  double log_score = 0.0;            ///< all states together [nats/sample]
  double loss = 0.0;                 ///< against the best of the table [nats/sample]
  double loss_standard_error = 0.0;  ///< over runs, or stretches of them [nats/sample]
  Eigen::VectorXd rmse = {};         ///< n, of the one-step prediction [state unit]
  bool chosen = false;               ///< for windows, mixture and bank
  bool linear = false;               ///< for one linear motion: baseline, noise_only; where terms are looked for
  bool one_motion = false;           ///< for one motion whose noise switches
  bool drifting = false;             ///< for one motion that wanders
  /// Causal log score of the training runs where coefficients wander [nats/sample]; NaN where this was not asked.
  double drifting_score = std::numeric_limits<double>::quiet_NaN();
  /// Scores of few modes, and of one motion whose noise switches, on training runs that were left out [nats/sample];
  /// NaN as above.
  double modes_score = std::numeric_limits<double>::quiet_NaN();
  double one_motion_score = std::numeric_limits<double>::quiet_NaN();
};

/// The lags and delay that windows, mixture and bank have, those of other stages (in the table), and how sure the
/// choice is.
struct FoundStructure {
  std::ptrdiff_t state_lags = 1;
  std::ptrdiff_t input_lags = 1;
  std::ptrdiff_t input_delay = 1;
  std::ptrdiff_t samples = 0;     ///< that every structure predicted
  std::ptrdiff_t parts = 0;       ///< runs, or stretches of runs, that standard errors are taken over
  bool by_runs = false;           ///< whether parts are whole runs
  std::ptrdiff_t structures = 0;  ///< that were compared by least squares
  /// Largest |t| of past innovations in a regression of the inputs on their own lags: large where the inputs answer to
  /// the states. NaN without inputs or without enough samples.
  double feedback_t = 0.0;
  double same_sample_t = 0.0;               ///< the same of the innovation of the input's own sample
  std::string remark = {};                  ///< what kept the search from its full range; empty: nothing
  std::vector<StructureScore> scores = {};  ///< of the finalists, the best first

  /// |t| above which the inputs are said to answer to past innovations.
  static constexpr double feedback_limit = 5.0;
  bool feedback() const { return feedback_t > feedback_limit; }
};

}  // namespace modebank
