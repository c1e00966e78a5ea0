#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "filter/judge/decide/diagnostics.hpp"
#include "filter/judge/run/free_run.hpp"
#include "filter/judge/run/horizon.hpp"
#include "filter/judge/score/paired_gain.hpp"
#include "filter/judge/score/scores.hpp"
#include "filter/step/bank.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/data/streams.hpp"
#include "ident/data/trajectory.hpp"
#include "modebank/base/names.hpp"

/// Whether held-out runs ask for modes of motion (method: section 6): the one place that decides it. Whoever prints it
/// prints what stands here.
namespace modebank {

/// not_yet: a simpler fact has to be settled first (Finding::step_scatter, Finding::pattern). not_comparable:
/// measurements are so coarse, or repeated so often, that log densities mean little.
enum class Answer { one_mode, not_comparable, cannot_tell, no_evidence, evidence, not_yet };

template <>
struct EnumNames<Answer> {
  static constexpr Names<6> values{"one mode", "not comparable", "cannot tell", "no evidence", "evidence", "not yet"};
};

/// The competitors that a bank is asked to beat, the simplest description first.
inline constexpr std::array<const char*, 5> competitor_names{"baseline", "noise_only", "one_motion", "drifting",
                                                             "nonlinear"};
/// What a competitor says that the runs are, "one linear model with constant noise"; empty for other names.
/// `one_motion_drifts`: whether the theta of `one_motion` does.
const char* description_of(const std::string& competitor, bool one_motion_drifts);

/// The simplest name that the scores leave for the motion of the judged runs. none: nothing was judged, or nothing is
/// told.
enum class Description { none, one_linear_motion, one_drifting_motion, one_nonlinear_motion, several_modes };

template <>
struct EnumNames<Description> {
  static constexpr Names<5> values{"none", "one linear motion", "one drifting motion", "one nonlinear motion",
                                   "several modes"};
};

/// Why an answer is `cannot tell`. errors_unknown: modes whose parameters have no standard error may be alike.
/// within_chance: the gain over some competitor is not told from zero. small_gain: it is, and less than counts.
/// short_stays: Finding::stay is below stay_asked.
enum class Doubt {
  nothing_held_out,
  no_competitor,
  few_samples,
  errors_unknown,
  within_chance,
  small_gain,
  short_stays
};

/// A description that loses less is as good [nats per sample], as where modes are counted (rule.hpp).
inline constexpr double negligible_gain = 0.02;

/// The part of a bank's errors on its training runs that past errors and inputs predict.
struct ErrorPattern {
  double gain = not_a_number;            ///< by predicting errors so, on parts left out [nats/sample]; NaN: unknown
  double standard_error = not_a_number;  ///< over those parts [nats/sample]

  /// Whether the gain counts, and exceeds two standard errors.
  bool told() const { return gain >= negligible_gain && gain > 2.0 * standard_error; }
};

/// What a filter said of the judged runs.
struct Densities {
  std::string filter;
  std::vector<Eigen::VectorXd> of_runs;  ///< log predictive density of every sample [nats], NaN where there is none
};

/// How finely a state is measured.
struct Resolution {
  std::string state;
  double quantum = 0.0;        ///< all values are multiples of it apart; 0: none seen
  double repeated = 0.0;       ///< share of samples in motion that equal the one before
  double innovation_sd = 0.0;  ///< median standard deviation of the bank's predictions in motion [state unit]
  double sd = 0.0;             ///< of the samples [state unit]; 0: not known
};

/// Share of repeated samples beyond which densities are not compared: measured noise hardly ever repeats to the last
/// digit.
inline constexpr double repeated_share = 0.1;

/// A competitor that predicts the mean better than the bank, in root mean square over the judged runs.
struct BetterMean {
  std::string competitor;
  Eigen::Index horizon = 1;  ///< samples ahead; 0: in free run
  std::string state;
  double rmse_bank = 0.0, rmse = 0.0;  ///< [state unit]
};

struct Finding {
  Answer answer = Answer::cannot_tell;
  Role role = Role::test;
  Eigen::Index runs = 0;           ///< judged, with scored samples
  Eigen::Index modes = 0;          ///< of the bank
  bool modes_differ = false;       ///< in theta, beyond their errors
  bool errors_known = true;        ///< errors_known of the bank: else modes may differ all the same
  double step_scatter = 0.0;       ///< standard deviation of the time steps over their median
  ErrorPattern pattern;            ///< of the bank's errors
  double stay = not_a_number;      ///< in a mode, harmonic mean over the samples judged [samples]; NaN: unknown
  double stay_asked = 0.0;         ///< for evidence [samples]
  std::vector<Resolution> coarse;  ///< states for which densities are not comparable
  bool without_noise = false;      ///< one linear model leaves no more of the runs than rounding
  bool one_motion_drifts = false;  ///< the competitor of that name learns within a run, as the bank does
  bool terms_asked = false;        ///< whether training runs were asked for terms of one nonlinear motion
  std::vector<PairedGain> gains;   ///< of the bank over each competitor
  std::string best_competitor;     ///< of highest log score; empty without competitors
  double gain = 0.0, standard_error = 0.0;  ///< over that one [nats/sample]; NaN where it is not known
  Description description = Description::none;
  std::string better_description;  ///< the competitor that describes the runs instead; empty where there is none
  double description_loss = 0.0;   ///< of that one against the best competitor [nats/sample]
  /// Where one nonlinear motion and several modes each gain over the better of baseline and noise_only, and either
  /// describes the runs: modes that switch by state and input are both. Else empty.
  std::string over_linear;
  double bank_over_linear = 0.0, nonlinear_over_linear = 0.0;  ///< [nats/sample]
  std::vector<BetterMean> better_means;
  std::vector<std::pair<std::string, double>> coefficients;  ///< of one linear model, where that leaves no noise
  std::vector<std::string> equations;  ///< of the nonlinear motion that describes the runs instead
  std::string text;                    ///< all of it in plain sentences, by whoever has words for it

  bool held_out() const { return role == Role::test; }
};

/// Whether some pair of modes differs in a parameter by more than its two standard errors allow, at 95 % for all pairs
/// and parameters together (Bonferroni). Parameters without a standard error tell no modes apart.
bool modes_differ(const Bank& bank);
/// Whether every parameter in which modes have different values has a standard error.
bool errors_known(const Bank& bank);

/// The first reason that the numbers of a finding give that cannot tell.
Doubt doubt_of(const Finding& finding);
/// The competitor that the bank's gain is least beyond chance over, one that it is not told from if there is one, in
/// units of its margin; null without a margin.
const PairedGain* least_beaten(const Finding& finding);

struct FindingInputs {
  const Bank& bank;
  Role role;  ///< of the judged runs
  const Densities& bank_densities;
  const std::vector<Densities>& competitors;
  const std::vector<SummaryRow>& summary;
  const std::vector<HorizonRow>& horizons;
  const std::vector<Resolution>& states;
  const std::vector<FreeRunRow>& free_runs;
  bool one_motion_drifts = false;
  double step_scatter = 0.0;  ///< as in Finding
  std::vector<DiagnosticsRow> diagnostics = {};
  ErrorPattern pattern = {};
};

/// not yet: the steps scatter beyond most_step_scatter, or the errors follow a pattern that lags would take away. one
/// mode: the bank has one, or one linear model leaves no noise: scores are then those of rounding. evidence: the gain
/// over each competitor is told (paired_gain.hpp) and not negligible, the modes differ, and they stay for five samples
/// and for the model's memory. no evidence: a competitor has no lower score, the gain over one is known to be
/// negligible, or all modes have the same theta. cannot tell: all between, nothing held out, too few samples for a
/// margin, or modes whose errors are not known. Modes that pass sooner are how noisy inputs and a delay that differs
/// between runs come back: no competitor has them. Where the bank is not beyond doubt better than the best competitor,
/// better_description is the simplest one that is as good as both: it loses less than 0.02 nats, or neither a t-test
/// nor Wilcoxon's over runs tells it apart.
Finding judge_modes(const FindingInputs& in);

}  // namespace modebank
