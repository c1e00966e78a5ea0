#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "filter/judge/evaluate.hpp"
#include "filter/judge/statistics.hpp"
#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"

namespace modebank {

/// One row of /evaluation/summary (method: section 6). Fractions refer to the scored samples.
struct SummaryRow {
  std::string filter;  ///< bank or a competitor
  Role role = Role::train;
  std::string run;           ///< "*": all runs of the role pooled
  Eigen::Index samples = 0;  ///< scored samples
  double log_score = 0.0;    ///< mean log predictive density [nats/sample], higher is better
  Eigen::VectorXd rmse;      ///< n_y, RMSE of the one-step prediction [state unit]
  double nis_mean = 0.0;     ///< sum of NIS divided by the number of scored signals, times n_y; a correct model has n_y
  double nis_above = 0.0;    ///< share of NIS above the 97.5 % quantile of chi-square for the sample's signals
  double nis_below = 0.0;    ///< share of NIS below the 2.5 % quantile
  double too_far = 0.0;      ///< share of z^2 above the 97.5 % quantile of chi-square(1), z = Phi^-1(pit)
  double too_close = 0.0;    ///< share of z^2 below the 2.5 % quantile
  double coverage_50 = 0.0, coverage_90 = 0.0, coverage_95 = 0.0, coverage_99 = 0.0;  ///< share of |z| inside the
                                                                                      ///< central band
  double pit_distance = 0.0;  ///< Kolmogorov distance of pit from the uniform distribution
  double whiteness_p = 0.0;   ///< p value of Ljung & Box (1978) for z, min(20, N/5) lags, pooled over runs by Fisher's
                              ///< method
};

/// Rows of one filter: each run of the role in order, then the pooled "*" row. Without runs there are no rows. Only the
/// runs of this role need an evaluation. `scores`: scores of the evaluations (score_runs).
std::vector<SummaryRow> summarize(const std::string& filter, Role role, const std::vector<Trajectory>& runs,
                                  const std::vector<RunEvaluation>& evaluations, const std::vector<RunScores>& scores);

/// Which values of a score are good. With `nominal`, a correct model has the nominal value, and values near it are
/// good.
struct ScoreGoal {
  enum class Kind { higher, lower, nominal } kind = Kind::higher;
  double nominal = 0.0;

  /// Loss of a score, NaN for NaN. A smaller loss is better.
  double loss(double score) const;
  std::string text() const;  ///< "higher", "lower" or "nearest 0.025"
};

/// Goal of a score. The score has its name in the summary, or `<filter>_<role>_<score>` (studies). Empty for columns
/// that are neither good nor bad (samples, modes). `states`: number of measured states, which is the mean NIS of a
/// correct model.
std::optional<ScoreGoal> goal_of(const std::string& score, int states);

/// The row of a filter over all runs of a role; null if there is none.
const SummaryRow* pooled_row(const std::vector<SummaryRow>& summary, const std::string& filter, Role role);

/// Role of the runs on which filters are judged: held-out runs, or the training runs if none are held out.
Role judged_role(const std::vector<SummaryRow>& summary);

}  // namespace modebank
