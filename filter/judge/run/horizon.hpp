#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "filter/judge/run/evaluate.hpp"
#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"

namespace modebank {

/// Predictions of a run's measurements, each made some samples before from what was known then and from the inputs that
/// were recorded since. Column k belongs to sample k; NaN where no filter stood so long before it, or where the
/// measurement is not whole.
struct HorizonEvaluation {
  std::vector<Eigen::Index> horizons;  ///< samples ahead, ascending
  std::vector<Eigen::MatrixXd> error;  ///< per horizon n_y x N: measurement minus combined prediction
  Eigen::MatrixXd log_density;         ///< horizons x N: log predictive density of the measurement [nats]
};

/// One of a run of n_y signals in which nothing is predicted yet; `horizons` in ascending order, each once. Throws
/// std::invalid_argument when one is below 1.
HorizonEvaluation empty_horizons(std::vector<Eigen::Index> horizons, Eigen::Index n_y, Eigen::Index samples);

/// `horizons`: each at least 1. At 1 it is what evaluate_run says. Same conditions as evaluate_run; costs as many steps
/// per sample as the longest horizon has.
HorizonEvaluation evaluate_horizons(const Bank& bank, const Trajectory& run, const FilterOptions& options,
                                    std::vector<Eigen::Index> horizons);

/// One row of /evaluation/horizon.
struct HorizonRow {
  std::string filter;  ///< bank or a competitor
  Role role = Role::train;
  std::string run;           ///< "*": pooled over the samples of all runs of the role
  Eigen::Index horizon = 1;  ///< samples ahead
  Eigen::Index samples = 0;  ///< scored
  double log_score = 0.0;    ///< mean log predictive density [nats/sample]
  Eigen::VectorXd rmse;      ///< n_y [state unit]
};

/// Sums over the scored samples of one or more runs at one horizon.
struct HorizonSums {
  Eigen::Index horizon = 1;  ///< samples ahead
  Eigen::Index samples = 0;
  double log_density = 0.0;
  Eigen::ArrayXd squared_error;  ///< n_y

  HorizonSums& operator+=(const HorizonSums& other);
};
/// One per horizon of a run.
std::vector<HorizonSums> sum_horizons(const HorizonEvaluation& run);

/// Rows of one filter, ordered as summarize() orders its own, every horizon in turn. `sums`: of every run.
std::vector<HorizonRow> summarize_horizons(const std::string& filter, const std::vector<Trajectory>& runs,
                                           const std::vector<std::vector<HorizonSums>>& sums);

}  // namespace modebank
