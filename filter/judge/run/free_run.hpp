#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"
#include "modebank/base/names.hpp"
#include "modebank/filter/options.hpp"

namespace modebank {

/// How a bank's free run is computed. moments: probability, mean and covariance of every mode, exact for a constant
/// transition matrix; bands and densities take every mode's distribution for a Gaussian. paths: sample paths; bands are
/// their quantiles, densities as above of their moments, and both are as noisy as so many paths are.
enum class FreeRunMethod { moments, paths };

template <>
struct EnumNames<FreeRunMethod> {
  static constexpr Names<2> values{"moments", "paths"};
};

/// What a free run starts from. estimated: what the filter knows after the measured samples. fixed: the last of them as
/// a filter's first measurement, all before it unseen.
enum class FreeRunStart { estimated, fixed };

template <>
struct EnumNames<FreeRunStart> {
  static constexpr Names<2> values{"estimated", "fixed"};
};

struct FreeRunOptions {
  Eigen::Index samples = 0;  ///< measured ones at the beginning; 0: no free run
  Eigen::Index horizon = 0;  ///< samples predicted after them; 0: to the end of the run
  FreeRunStart start = FreeRunStart::estimated;
  FreeRunMethod method = FreeRunMethod::moments;
  Eigen::Index paths = 400;
  std::uint64_t seed = 1;  ///< of the paths; every run has its own generator by its name

  bool operator==(const FreeRunOptions&) const = default;
};

/// The fewest measured samples that a model can start from.
inline Eigen::Index fewest_start_samples(const LinearStructure& structure) { return structure.first_transition() + 1; }

/// Predictions of a run after its first samples, from these and the inputs alone. Column k belongs to sample k; NaN
/// (-1) where nothing was predicted. After a time without samples for which filters start anew, the free run does, too.
struct FreeRun {
  Eigen::MatrixXd mean;            ///< n_y x N
  Eigen::MatrixXd deviation;       ///< n_y x N, standard deviation of the measurement about it
  Eigen::MatrixXd lower, upper;    ///< n_y x N, central 95 % band
  Eigen::MatrixXd pit;             ///< n_y x N, of every signal by itself; NaN where the measurement is not whole
  Eigen::VectorXd log_density;     ///< N, of the measurement jointly [nats]
  Eigen::VectorXi mode;            ///< N, most probable
  Eigen::Index lost_paths = 0;     ///< paths that left the finite range and were taken out
  std::vector<std::string> notes;  ///< why there is no prediction where there is none
};

/// Conditions as those of evaluate_run; throws std::invalid_argument for fewer samples than the model needs. Of banks
/// whose noise runs coefficients decay as where horizons are predicted (DriftingForecast), and it is always by moments.
FreeRun free_run(const Bank& bank, const Trajectory& run, const FilterOptions& filter, const FreeRunOptions& options);

/// One row of /evaluation/free_run. Over the samples that are predicted and measured; each signal by itself, but for
/// the log score.
struct FreeRunRow {
  std::string filter;  ///< bank or a competitor
  Role role = Role::train;
  std::string run;  ///< "*": pooled over the samples of all runs of the role
  FreeRunMethod method = FreeRunMethod::moments;
  Eigen::Index start = 0;    ///< measured samples at the beginning
  Eigen::Index samples = 0;  ///< scored
  double log_score = 0.0;    ///< mean log predictive density [nats/sample]
  Eigen::VectorXd rmse;      ///< n_y [state unit]
  Eigen::VectorXd nrmse;     ///< n_y, RMSE over the standard deviation of the measurements (about their mean, over N)
  Eigen::VectorXd fit;       ///< n_y [%], 100 (1 - ||y - mean|| / ||y - average of y||)
  Eigen::VectorXd coverage_50, coverage_90, coverage_95, coverage_99;  ///< n_y, share inside the central bands
  Eigen::Index lost_paths = 0;
};

/// Rows of one filter, ordered as summarize() orders its own.
std::vector<FreeRunRow> summarize_free_runs(const std::string& filter, const std::vector<Trajectory>& runs,
                                            const std::vector<FreeRun>& free_runs, const FreeRunOptions& options);

}  // namespace modebank
