#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "filter/judge/diagnostics.hpp"
#include "filter/judge/scores.hpp"
#include "filter/step/bank.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/data/streams.hpp"
#include "ident/data/trajectory.hpp"
#include "modebank/base/names.hpp"

/// Decides whether held-out runs require modes of motion (method: section 6). All output uses this result.
namespace modebank {

/// Loss below which a forecast counts as equally good [nats per sample].
inline constexpr double negligible_gain = 0.02;

/// Gain of one filter over another on the same samples.
struct PairedGain {
  std::string competitor;
  Eigen::Index samples = 0;     ///< number of samples that both filters scored
  double gain = 0.0;            ///< mean difference of log density [nats/sample]; NaN without samples
  double standard_error = 0.0;  ///< standard error of the gain; NaN if unknown
  double degrees_of_freedom = 0.0;
  double margin = 0.0;      ///< smallest significant gain, t(0.975, degrees of freedom) standard errors; NaN if unknown
  bool by_blocks = false;   ///< whether clusters are blocks of samples instead of runs
  double rank_p = 1.0;      ///< Wilcoxon's signed ranks of the mean differences per run, or per block of samples
  double least_gain = 0.0;  ///< smallest gain that counts, least_nats / samples; not archived

  /// False if the standard error is unknown.
  bool exceeds() const { return gain > margin; }
  bool ranks_tell() const { return rank_p < 0.05; }
  /// Significant by the paired t-test (one-sided, 2.5 %) and, as one odd run can distort it, by signed ranks (5 %).
  bool told() const { return exceeds() && ranks_tell(); }
  bool is_negligible() const { return gain < least_gain; }
  bool counts() const { return told() && !is_negligible(); }
  bool falls_short() const { return gain < -margin; }
};

/// `better`, `other`: log densities of each run's samples [nats], NaN if missing. The standard error of the mean m of N
/// differences is clustered by G runs, with n_r samples and sum d_r (linearised ratio: Cochran 1977, section 6.3):
///   SE^2 = G / (G - 1) sum_r (d_r - m n_r)^2 / N^2,   df = G - 1.
/// With fewer than five runs the clusters are moving blocks of b samples inside runs (Kuensch 1989, Annals of
/// Statistics 17), at least two autocorrelation times of the differences long. S_i is the sum over block i, B the
/// number of blocks that fit side by side; with fewer than eight the error is unknown (NaN):
///   SE^2 = B / (B - 1) mean_i (S_i - b m)^2 / (b N),   df = B - 1.
/// `response_samples`: of one linear model (step/motions.hpp).
PairedGain paired_gain(const std::string& competitor, const std::vector<Eigen::VectorXd>& better,
                       const std::vector<Eigen::VectorXd>& other, double response_samples = 1.0);

/// not_yet: step_scatter or pattern must be settled first. not_comparable: measurements are repeated too often.
enum class Answer { one_mode, not_comparable, cannot_tell, no_evidence, evidence, not_yet };

template <>
struct EnumNames<Answer> {
  static constexpr Names<6> values{"one mode", "not comparable", "cannot tell", "no evidence", "evidence", "not yet"};
};

/// The competitors of a bank, the simplest description first.
inline constexpr std::array<const char*, 5> competitor_names{"baseline", "noise_only", "one_motion", "drifting",
                                                             "nonlinear"};
/// A competitor's description of the runs in words; empty for other names.
const char* description_of(const std::string& competitor);

/// The simplest description of the judged runs' motion that the scores allow. none: the result is inconclusive.
enum class Description { none, one_linear_motion, one_drifting_motion, one_nonlinear_motion, several_modes };

template <>
struct EnumNames<Description> {
  static constexpr Names<5> values{"none", "one linear motion", "one drifting motion", "one nonlinear motion",
                                   "several modes"};
};

/// Why an answer is `cannot tell`. within_chance: the gain over some competitor is not significant. small_gain: it is
/// significant, but may be negligible. short_stays: Finding::stay is below stay_asked.
enum class Doubt { nothing_held_out, no_competitor, few_samples, within_chance, small_gain, short_stays };

/// The part of a bank's training errors that can be predicted from past errors and inputs.
struct ErrorPattern {
  double gain = not_a_number;            ///< from predicting the errors of left-out parts of the runs [nats/sample]
  double standard_error = not_a_number;  ///< of the gain, over these parts

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
  double repeated = 0.0;  ///< share of the samples in motion that equal the one before; 0 with a known quantum
  double sd = 0.0;        ///< standard deviation of the samples [state unit]; 0 if unknown
};

/// Share of repeated samples above which densities are not compared. Noisy measurements hardly ever repeat.
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
  Eigen::Index motions = 0;           ///< number of motions that count (counted_motions); not archived
  double step_scatter = 0.0;          ///< standard deviation of the time steps, divided by their median
  ErrorPattern pattern;               ///< pattern in the errors of the bank
  double stay = not_a_number;         ///< mean stay in a motion (harmonic mean) [samples]; NaN if unknown or endless
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
  std::vector<std::pair<std::string, double>> coefficients;  ///< of one linear model that leaves no noise
  std::vector<std::string> equations;  ///< of the nonlinear motion, if it describes the runs in place of modes
  std::string text;                    ///< the finding in plain sentences, filled in by the output

  bool held_out() const { return role == Role::test; }
};

/// The gain over a competitor; null without its scores.
const PairedGain* gain_over(const Finding& finding, const std::string& competitor);
/// The first reason for the answer `cannot tell`.
Doubt doubt_of(const Finding& finding);
/// The gain that is least significant (gain divided by its margin); an insignificant one comes first. Null if a margin
/// is unknown.
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
  double response_samples = 1.0;  ///< 63 % response time of `baseline` (step/motions.hpp)
};

/// Decides whether the runs require modes.
/// - not yet: the steps scatter beyond most_step_scatter, or further lags would remove a pattern in the errors.
/// - one mode: one motion counts (counted_motions), and stays are long enough to say so; or one linear model leaves no
///   noise (scores are then scores of rounding).
/// - evidence: the gain over each competitor is significant and not negligible, and motions last at least five samples
///   and the memory of the model. Shorter stays appear with noisy inputs or a delay that differs between runs, which
///   competitors do not model. Modes that differ in noise alone gain nothing over `one_motion`, which has their noises.
/// - no evidence: the gain over a competitor is known to be negligible, since even its upper limit is.
/// - cannot tell: all other cases, such as no held-out runs, or too few samples for a margin.
/// Without a gain that counts over the best competitor, better_description is the simplest one as good as the best and
/// the bank: it loses less than counts as a gain, or neither a t-test nor Wilcoxon's test over runs separates the two.
Finding judge_modes(const FindingInputs& in);

}  // namespace modebank
