#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "filter/judge/evaluate.hpp"
#include "filter/step/bank.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/data/trajectory.hpp"

namespace modebank {

/// Predictions of a run's measurements. A prediction is made some samples earlier, from the measurements up to that
/// time and the inputs recorded since. Column k belongs to sample k. NaN if no filter was running at that time, or if
/// the measurement is incomplete.
struct HorizonEvaluation {
  std::vector<Eigen::Index> horizons;  ///< samples ahead, ascending
  std::vector<Eigen::MatrixXd> error;  ///< per horizon n_y x N: measurement minus combined prediction
  std::vector<Eigen::MatrixXd> pit;    ///< per horizon n_y x N: P(y_i <= measurement) of each signal by itself
  Eigen::MatrixXd log_density;         ///< horizons x N: log predictive density of the measurement [nats]
};

/// An empty evaluation for a run of n_y signals. `horizons`: ascending, without duplicates. Throws
/// std::invalid_argument for a horizon below 1.
HorizonEvaluation empty_horizons(std::vector<Eigen::Index> horizons, Eigen::Index n_y, Eigen::Index samples);

/// Evaluates predictions at several horizons, each at least 1; horizon 1 equals evaluate_run. Conditions are those of
/// evaluate_run. The cost per sample is one step per sample of the longest horizon.
HorizonEvaluation evaluate_horizons(const Bank& bank, const Trajectory& run, const FilterOptions& options,
                                    std::vector<Eigen::Index> horizons);

/// One row of /evaluation/horizon.
struct HorizonRow {
  std::string filter;  ///< bank or a competitor
  Role role = Role::train;
  std::string run;                    ///< name of the run; "*": all runs of the role pooled
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

/// Rows of one filter in the order of summarize_free_runs(), each with all horizons. `sums`: the sums of every run.
std::vector<HorizonRow> summarize_horizons(const std::string& filter, const std::vector<Trajectory>& runs,
                                           const std::vector<std::vector<HorizonSums>>& sums);

}  // namespace modebank
