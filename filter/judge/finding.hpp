#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "filter/judge/diagnostics.hpp"
#include "filter/judge/free_run.hpp"
#include "filter/judge/horizon.hpp"
#include "filter/judge/paired_gain.hpp"
#include "filter/judge/scores.hpp"
#include "filter/step/bank.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/data/streams.hpp"
#include "ident/data/trajectory.hpp"
#include "modebank/base/names.hpp"

/// Decides whether held-out runs require modes of motion (method: section 6). All output uses this result.
namespace modebank {

/// not_yet: a simpler fact must be settled first (Finding::step_scatter, Finding::pattern). not_comparable: log
/// densities cannot be compared, because measurements are repeated too often.
enum class Answer { one_mode, not_comparable, cannot_tell, no_evidence, evidence, not_yet };

template <>
struct EnumNames<Answer> {
  static constexpr Names<6> values{"one mode", "not comparable", "cannot tell", "no evidence", "evidence", "not yet"};
};

/// The competitors of a bank, the simplest description first.
inline constexpr std::array<const char*, 5> competitor_names{"baseline", "noise_only", "one_motion", "drifting",
                                                             "nonlinear"};
/// A competitor's description of the runs, such as "one linear model with constant noise"; empty for other names.
const char* description_of(const std::string& competitor);

/// The simplest description of the judged runs' motion that the scores allow. none: no run was judged, or the result is
/// inconclusive.
enum class Description { none, one_linear_motion, one_drifting_motion, one_nonlinear_motion, several_modes };

template <>
struct EnumNames<Description> {
  static constexpr Names<5> values{"none", "one linear motion", "one drifting motion", "one nonlinear motion",
                                   "several modes"};
};

/// Why an answer is `cannot tell`.
/// - within_chance: the gain over some competitor is not significant.
/// - small_gain: the gain is significant but too small.
/// - short_stays: Finding::stay is below stay_asked.
enum class Doubt { nothing_held_out, no_competitor, few_samples, within_chance, small_gain, short_stays };

/// Loss below which a description counts as equally good [nats per sample]. The choice of the number of modes uses the
/// same value (rule.hpp).
inline constexpr double negligible_gain = 0.02;

/// The part of a bank's training errors that can be predicted from past errors and inputs.
struct ErrorPattern {
  double gain = not_a_number;  ///< gain from predicting the errors, on left-out parts of the runs [nats/sample]; NaN
                               ///< means unknown
  double standard_error = not_a_number;  ///< standard error of the gain over these parts [nats/sample]

  /// Whether the gain is not negligible and exceeds two standard errors.
  bool told() const { return gain >= negligible_gain && gain > 2.0 * standard_error; }
};

/// Log densities of one filter on the judged runs.
struct Densities {
  std::string filter;
  std::vector<Eigen::VectorXd> of_runs;  ///< log predictive density of every sample [nats], NaN if there is none
};

/// Resolution of a state's measurement.
struct Resolution {
  std::string state;
  double repeated = 0.0;  ///< share of the samples in motion that equal the previous sample; 0 if a known quantum
                          ///< explains repetitions
  double sd = 0.0;        ///< standard deviation of the samples [state unit]; 0 if unknown
};

/// Limit on the share of repeated samples; above the limit, densities are not compared. In noisy measurements two
/// samples are hardly ever equal to the last digit.
inline constexpr double repeated_share = 0.1;

/// A competitor with a smaller root mean square error than the bank over the judged runs.
struct BetterMean {
  std::string competitor;
  Eigen::Index horizon = 1;  ///< samples ahead; 0 for a free run
  std::string state;
  double rmse_bank = 0.0, rmse = 0.0;  ///< [state unit]
};

struct Finding {
  Answer answer = Answer::cannot_tell;
  Role role = Role::test;
  Eigen::Index runs = 0;              ///< number of judged runs with scored samples
  bool stretches = false;             ///< whether the runs are stretches of one drive; filled in by the output
  Eigen::Index modes = 0;             ///< number of modes of the bank
  double step_scatter = 0.0;          ///< standard deviation of the time steps, divided by their median
  ErrorPattern pattern;               ///< pattern in the errors of the bank
  double stay = not_a_number;         ///< mean stay in a mode (harmonic mean over the judged samples) [samples]; NaN if
                                      ///< unknown
  double stay_asked = 0.0;            ///< smallest stay for evidence [samples]
  std::vector<Resolution> repeating;  ///< states for which densities are not comparable
  bool without_noise = false;         ///< whether one linear model explains the runs up to rounding
  bool terms_asked = false;           ///< whether terms of one nonlinear motion were searched on the training runs
  std::vector<PairedGain> gains;      ///< gains of the bank over each competitor
  std::string best_competitor;        ///< competitor with the highest log score; empty without competitors
  double gain = 0.0, standard_error = 0.0;  ///< gain over best_competitor [nats/sample]; NaN if unknown
  Description description = Description::none;
  std::string better_description;  ///< competitor that describes the runs in place of modes; empty if there is none
  std::vector<BetterMean> better_means;
  std::vector<std::pair<std::string, double>> coefficients;  ///< coefficients of one linear model; empty if the model
                                                             ///< leaves noise
  std::vector<std::string> equations;  ///< equations of the nonlinear motion, if it describes the runs in place of
                                       ///< modes
  std::string text;                    ///< the finding in plain sentences, filled in by the output

  bool held_out() const { return role == Role::test; }
};

/// The first reason for the answer `cannot tell` in the numbers of a finding.
Doubt doubt_of(const Finding& finding);
/// The competitor over which the bank's gain is least significant (gain divided by its margin). A competitor with an
/// insignificant gain comes first. Null if no gain has a margin.
const PairedGain* least_beaten(const Finding& finding);

struct FindingInputs {
  const Bank& bank;
  Role role;  ///< role of the judged runs
  const Densities& bank_densities;
  const std::vector<Densities>& competitors;
  const std::vector<SummaryRow>& summary;
  const std::vector<HorizonRow>& horizons;
  const std::vector<Resolution>& states;
  const std::vector<FreeRunRow>& free_runs;
  double step_scatter = 0.0;  ///< as in Finding
  std::vector<DiagnosticsRow> diagnostics = {};
  ErrorPattern pattern = {};
};

/// Decides whether the runs require modes.
/// - not yet: the steps scatter beyond most_step_scatter, or further lags would remove a pattern in the errors.
/// - one mode: the bank has one mode, or one linear model leaves no noise (scores are then scores of rounding).
/// - evidence: the gain over each competitor is significant (paired_gain.hpp) and not negligible, and stays are long
///   enough. Modes that differ in noise alone gain nothing over `one_motion`, which has their noises. A stay must last
///   at least five samples and the memory of the model. Shorter stays appear with noisy inputs or a delay that differs
///   between runs; competitors do not model these effects.
/// - no evidence: the gain over a competitor is known to be negligible, since even its upper limit is.
/// - cannot tell: all other cases, such as no held-out runs, or too few samples for a margin.
/// If the bank is not significantly better than the best competitor, better_description is the simplest competitor that
/// is as good as these two. A competitor is as good if it loses less than 0.02 nats, or if neither a t-test nor
/// Wilcoxon's test over runs separates the two.
Finding judge_modes(const FindingInputs& in);

}  // namespace modebank
