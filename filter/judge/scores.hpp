#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "filter/judge/evaluate.hpp"
#include "filter/judge/horizon.hpp"
#include "filter/judge/statistics.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/data/trajectory.hpp"

/// Tables of scores. Rows of a role: each run in order, then "*", all of its runs together.
namespace modebank {

/// One row of /evaluation/summary (method: section 6). Fractions refer to the scored samples.
struct SummaryRow {
  std::string filter;  ///< bank or a competitor
  Role role = Role::train;
  std::string run;            ///< "*": all runs of the role pooled
  Eigen::Index samples = 0;   ///< scored samples
  double log_score = 0.0;     ///< mean log predictive density [nats/sample], higher is better
  Eigen::VectorXd rmse = {};  ///< n_y, RMSE of the one-step prediction [state unit]
  double nis_mean = 0.0;   ///< sum of NIS divided by the number of scored signals, times n_y; a correct model has n_y
  double nis_above = 0.0;  ///< share of NIS above the 97.5 % quantile of chi-square for the sample's signals
  double nis_below = 0.0;  ///< share of NIS below the 2.5 % quantile
  double too_far = 0.0;    ///< share of z^2 above the 97.5 % quantile of chi-square(1), z = Phi^-1(pit)
  double too_close = 0.0;  ///< share of z^2 below the 2.5 % quantile
  double coverage_50 = 0.0, coverage_90 = 0.0, coverage_95 = 0.0, coverage_99 = 0.0;  ///< shares of |z| inside a band
  double pit_distance = 0.0;  ///< Kolmogorov distance of pit from the uniform distribution
  double whiteness_p = 0.0;   ///< whiteness_p of the runs, pooled by Fisher's method
};

/// Rows of one filter and role. Only the runs of this role need an evaluation. `scores`: of the evaluations.
std::vector<SummaryRow> summarize(const std::string& filter, Role role, const std::vector<Trajectory>& runs,
                                  const std::vector<RunEvaluation>& evaluations, const std::vector<RunScores>& scores);

/// One row of /evaluation/horizon.
struct HorizonRow {
  std::string filter;
  Role role = Role::train;
  std::string run;
  Eigen::Index horizon = 1;           ///< samples ahead
  Eigen::Index samples = 0;           ///< scored samples
  double log_score = 0.0;             ///< mean log predictive density [nats/sample]
  Eigen::VectorXd rmse;               ///< n_y [state unit]
  double coverage_95 = not_a_number;  ///< share of the signals inside the central 95 % band
};

/// Sums over the scored samples of one or more runs at one horizon.
struct HorizonSums {
  Eigen::Index horizon = 1;  ///< samples ahead
  Eigen::Index samples = 0;
  double log_density = 0.0;
  Eigen::ArrayXd squared_error;  ///< n_y
  double inside = 0.0;           ///< number of signals inside the central 95 % band
};
/// The sums of a run, one element per horizon.
std::vector<HorizonSums> sum_horizons(const HorizonEvaluation& run);
/// Adds the sums of a run to those of all runs, which are empty at first.
void pool(const std::vector<HorizonSums>& run, std::vector<HorizonSums>& all);

/// Rows of one filter: training runs, then held-out runs, each with all horizons. `sums`: the sums of every run.
std::vector<HorizonRow> summarize_horizons(const std::string& filter, const std::vector<Trajectory>& runs,
                                           const std::vector<std::vector<HorizonSums>>& sums);

/// One row of /evaluation/free_run: scores over samples that are predicted and measured. All scores are per signal,
/// except the log score.
struct FreeRunRow {
  std::string filter;
  Role role = Role::train;
  std::string run;
  Eigen::Index start = 0;      ///< number of measured samples at the beginning
  Eigen::Index samples = 0;    ///< scored samples
  double log_score = 0.0;      ///< mean log predictive density [nats/sample]
  Eigen::VectorXd rmse = {};   ///< n_y [state unit]
  Eigen::VectorXd nrmse = {};  ///< n_y, RMSE divided by the standard deviation of the measurements (divisor N)
  Eigen::VectorXd fit = {};    ///< n_y [%], 100 (1 - ||y - mean|| / ||y - average of y||)
  Eigen::VectorXd coverage_50 = {}, coverage_90 = {}, coverage_95 = {}, coverage_99 = {};  ///< n_y, as in SummaryRow
  Eigen::Index lost_paths = 0;
};

/// Rows of one filter: training runs, then held-out runs.
std::vector<FreeRunRow> summarize_free_runs(const std::string& filter, const std::vector<Trajectory>& runs,
                                            const std::vector<FreeRun>& free_runs, const FreeRunOptions& options);

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
