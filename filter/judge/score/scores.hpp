#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "filter/judge/run/evaluate.hpp"
#include "filter/judge/score/statistics.hpp"
#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"

namespace modebank {

/// One row of /evaluation/summary (method: section 6). Fractions are of the scored samples.
struct SummaryRow {
  std::string filter;  ///< bank or a competitor
  Role role = Role::train;
  std::string run;           ///< "*": pooled over the samples of all runs of the role
  Eigen::Index samples = 0;  ///< scored samples
  double log_score = 0.0;    ///< mean log predictive density [nats/sample], higher is better
  Eigen::VectorXd rmse;      ///< n_y, of the one-step prediction [state unit]
  double nis_mean = 0.0;     ///< sum of NIS over the number of scored signals, times n_y: n_y in a true filter
  double nis_above = 0.0;    ///< NIS above the 97.5 % quantile of chi-square of the sample's signals
  double nis_below = 0.0;    ///< NIS below the 2.5 % quantile
  double too_far = 0.0;      ///< z^2 above the 97.5 % quantile of chi-square(1), z = Phi^-1(pit)
  double too_close = 0.0;    ///< z^2 below the 2.5 % quantile
  double coverage_50 = 0.0, coverage_90 = 0.0, coverage_95 = 0.0, coverage_99 = 0.0;  ///< |z| inside the central band
  double pit_distance = 0.0;  ///< Kolmogorov distance of pit from uniform
  double whiteness_p = 0.0;   ///< Ljung & Box (1978) p of z, min(20, N/5) lags, pooled over runs by Fisher's method
};

/// Rows of one filter: each run of the role in order, then the pooled "*" row, train first. A role without runs has no
/// rows. `scores`: of the evaluations (score_runs).
std::vector<SummaryRow> summarize(const std::string& filter, const std::vector<Trajectory>& runs,
                                  const std::vector<RunEvaluation>& evaluations, const std::vector<RunScores>& scores);
/// Those of one role, whose runs alone need an evaluation.
std::vector<SummaryRow> summarize_role(const std::string& filter, Role role, const std::vector<Trajectory>& runs,
                                       const std::vector<RunEvaluation>& evaluations,
                                       const std::vector<RunScores>& scores);

/// What a limit on the number of modes cost on the runs of one role: a row of /bank/merged.
struct MergingCost {
  Role role = Role::train;
  Eigen::Index components = 0;       ///< of the mixture, before the closest ones were merged
  Eigen::Index modes_unlimited = 0;  ///< of the bank learned without the limit
  Eigen::Index modes = 0;            ///< of the bank learned with it
  Eigen::Index samples = 0;          ///< scored
  double log_score_unlimited = 0.0;  ///< mean log predictive density [nats/sample]
  double log_score = 0.0;
  double loss = 0.0;  ///< of log score by the limit; negative where the bank is better with it
};

/// One row per role that has runs. `components`: of the mixture that both banks were learned from.
std::vector<MergingCost> merging_costs(const Bank& unlimited, const Bank& limited, Eigen::Index components,
                                       const Recording& recording, const FilterOptions& options);

/// Which values of a score are good. `nominal`: the nearer to a true filter's value the better.
struct ScoreGoal {
  enum class Kind { higher, lower, nominal } kind = Kind::higher;
  double nominal = 0.0;

  /// The smaller, the better; NaN for NaN.
  double loss(double score) const;
  std::string text() const;  ///< "higher", "lower" or "nearest 0.025"
};

/// Goal of a score by its name in the summary, or by `<filter>_<role>_<score>` (studies); nothing for columns that are
/// neither good nor bad (samples, modes). `states` is the number of measured states, the mean of a true filter's NIS.
std::optional<ScoreGoal> goal_of(const std::string& score, int states);

/// The row of a filter over all runs of a role; null without.
const SummaryRow* pooled_row(const std::vector<SummaryRow>& summary, const std::string& filter, Role role);

/// The runs that filters are judged on: those held out, or, where nothing was, those they learned from.
Role judged_role(const std::vector<SummaryRow>& summary);

}  // namespace modebank
