#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "filter/judge/free_run.hpp"
#include "filter/judge/horizon.hpp"
#include "filter/judge/paired_gain.hpp"
#include "filter/judge/scores.hpp"
#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"
#include "modebank/base/names.hpp"

/// Whether held-out runs ask for modes of motion (method: section 6): the one place that decides it. Whoever prints it
/// prints what stands here.
namespace modebank {

/// not_yet: a simpler fact has to be settled first (Finding::step_scatter). not_comparable: measurements are so coarse,
/// or repeated so often, that log densities mean little.
enum class Answer { one_mode, not_comparable, cannot_tell, no_evidence, evidence, not_yet };

template <>
struct EnumNames<Answer> {
  static constexpr Names<6> values{"one mode", "not comparable", "cannot tell", "no evidence", "evidence", "not yet"};
};

/// The competitors that a bank is asked to beat, the simplest description first.
inline constexpr std::array<const char*, 4> competitor_names{"baseline", "noise_only", "one_motion", "drifting"};
/// What a competitor says that the runs are, "one linear model with constant noise"; empty for other names.
/// `one_motion_drifts`: whether the theta of `one_motion` does.
const char* description_of(const std::string& competitor, bool one_motion_drifts);

/// What a filter said of the judged runs.
struct Densities {
  std::string filter;
  std::vector<Eigen::VectorXd> of_runs;  ///< log predictive density of every sample [nats], NaN where there is none
};

/// How finely a state is measured.
struct Resolution {
  std::string state;
  double quantum = 0.0;        ///< all values are multiples of it apart; 0: none seen
  double repeated = 0.0;       ///< share of samples equal to the one before
  double innovation_sd = 0.0;  ///< median standard deviation of the bank's predictions [state unit]
};

/// Share of repeated samples beyond which densities are not compared: measured noise hardly ever repeats to the last
/// digit.
inline constexpr double repeated_share = 0.1;

/// Scatter of the steps beyond which modes are not asked for: the model holds for one step length, so that one motion
/// at steps of many lengths looks like several.
inline constexpr double most_step_scatter = 0.1;

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
  Eigen::Index runs = 0;                    ///< judged, with scored samples
  Eigen::Index modes = 0;                   ///< of the bank
  bool modes_differ = false;                ///< in theta, beyond their errors
  double step_scatter = 0.0;                ///< standard deviation of the time steps over their median
  std::vector<Resolution> coarse;           ///< states for which densities are not comparable
  bool one_motion_drifts = false;           ///< the competitor of that name learns within a run, as the bank does
  std::vector<PairedGain> gains;            ///< of the bank over each competitor
  std::string best_competitor;              ///< of highest log score; empty without competitors
  double gain = 0.0, standard_error = 0.0;  ///< over that one [nats/sample]; NaN where it is not known
  std::string better_description;  ///< the competitor that describes the runs instead; empty where there is none
  std::vector<BetterMean> better_means;
  std::string text;  ///< all of it in plain sentences, by whoever has words for it

  bool held_out() const { return role == Role::test; }
};

/// Whether some pair of modes differs in a parameter by more than its two standard errors allow, at 95 % for all pairs
/// and parameters together (Bonferroni).
bool modes_differ(const Bank& bank);

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
};

/// not yet: the steps scatter beyond most_step_scatter. evidence: the gain over each competitor exceeds its margin (paired_gain.hpp) and the modes differ. no evidence: a
/// competitor has no lower score, or all modes have the same theta. cannot tell: all between, nothing held out, or too
/// few samples for a margin. With one mode the question is not asked.
Finding judge_modes(const FindingInputs& in);

}  // namespace modebank
