#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"
#include "modebank/filter/options.hpp"

namespace modebank {

struct FreeRunOptions {
  Eigen::Index samples = 0;  ///< number of measured samples at the beginning; 0 turns free runs off
  Eigen::Index paths = 400;  ///< number of sample paths, for banks that need them
  std::uint64_t seed = 1;    ///< seed of the paths; each run derives its own generator from its name

  bool operator==(const FreeRunOptions&) const = default;
};

/// Smallest number of measured samples that a model can start from.
inline Eigen::Index fewest_start_samples(const LinearStructure& structure) { return structure.first_transition() + 1; }

/// Predictions of a run from its first samples and the inputs alone. Column k belongs to sample k; a value is NaN (a
/// mode is -1) if the sample was not predicted. The free run restarts after each gap at which filters restart.
struct FreeRun {
  Eigen::MatrixXd mean;          ///< n_y x N
  Eigen::MatrixXd deviation;     ///< n_y x N, standard deviation of the measurement about `mean`
  Eigen::MatrixXd lower, upper;  ///< n_y x N, central 95 % band
  Eigen::MatrixXd
      pit;  ///< n_y x N, P(y_i <= measurement) of each signal by itself; NaN unless the measurement is complete
  Eigen::VectorXd log_density;     ///< N, joint log density of the measurement [nats]
  Eigen::VectorXi mode;            ///< N, most probable mode
  Eigen::Index lost_paths = 0;     ///< number of paths that diverged and were removed
  std::vector<std::string> notes;  ///< reasons for missing predictions
};

/// Computes a free run by the moments of every mode, which are exact for a constant transition matrix; bands and
/// densities treat every mode's distribution as Gaussian. Banks whose transitions depend on the state need sample paths
/// (SamplePaths); their number is finite, so bands and densities have sampling noise. The coefficients of banks with
/// running noise decay as in predictions at a horizon (DriftingForecast). The conditions are those of evaluate_run.
/// Throws std::invalid_argument for fewer samples than the model needs.
FreeRun free_run(const Bank& bank, const Trajectory& run, const FilterOptions& filter, const FreeRunOptions& options);

/// One row of /evaluation/free_run: scores over samples that are predicted and measured. All scores are per signal,
/// except the log score.
struct FreeRunRow {
  std::string filter;  ///< bank or a competitor
  Role role = Role::train;
  std::string run;           ///< name of the run; "*": all runs of the role pooled
  Eigen::Index start = 0;    ///< number of measured samples at the beginning
  Eigen::Index samples = 0;  ///< scored samples
  double log_score = 0.0;    ///< mean log predictive density [nats/sample]
  Eigen::VectorXd rmse;      ///< n_y [state unit]
  Eigen::VectorXd nrmse;     ///< n_y, RMSE divided by the standard deviation of the measurements (about their mean,
                             ///< divisor N)
  Eigen::VectorXd fit;       ///< n_y [%], 100 (1 - ||y - mean|| / ||y - average of y||)
  Eigen::VectorXd coverage_50, coverage_90, coverage_95, coverage_99;  ///< n_y, share of the samples inside the central
                                                                       ///< bands
  Eigen::Index lost_paths = 0;
};

/// Rows of one filter: training runs in order, then the pooled "*" row; then held-out runs.
std::vector<FreeRunRow> summarize_free_runs(const std::string& filter, const std::vector<Trajectory>& runs,
                                            const std::vector<FreeRun>& free_runs, const FreeRunOptions& options);

}  // namespace modebank
