#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "filter/judge/horizon.hpp"
#include "filter/judge/scores.hpp"
#include "filter/step/combined_filter.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/data/trajectory.hpp"

/// Combination of the forecasts of the bank and its competitors, weighted by past success within the run.
namespace modebank {

/// Forecasts of several filters for one run, combined by the ForecastWeights at their origin, which restart every run.
struct CombinedForecasts {
  HorizonEvaluation predictions;
  /// F x N per horizon: the filters' weights in the forecast of a sample; NaN if the sample was not scored.
  std::vector<Eigen::MatrixXd> weight;
};
/// `members`: forecasts of the same run and horizons, at least one. A sample is scored if the first member scores it.
/// `start`: starting weights per horizon; if empty, weights are equal.
CombinedForecasts combine_forecasts(const std::vector<HorizonEvaluation>& members,
                                    const std::vector<std::vector<double>>& start = {});

/// Mean weight of a filter; one row of /evaluation/combination.
struct CombinationRow {
  Role role = Role::train;
  Eigen::Index horizon = 1;  ///< samples ahead
  std::string filter;
  double weight = 0.0;          ///< mean over the scored samples of all runs of the role
  double start = not_a_number;  ///< weight at the start of a held-out or later run
};

/// One row of /bank/left_out: scores of a filter on the training runs, each by a fit that was learned without it. They
/// choose the filter that is named for prediction, and the starting weights of the combination.
struct LeftOutRow {
  std::string filter;           ///< bank, a competitor or combined_name
  Eigen::Index horizon = 1;     ///< samples ahead
  Eigen::Index samples = 0;     ///< scored samples
  double log_score = 0.0;       ///< mean log predictive density [nats/sample]
  Eigen::VectorXd rmse;         ///< n_y [state unit]
  double start = not_a_number;  ///< starting weight in combined forecasts; NaN for combined_name
};
/// Rows of the filters, and of two or more filters' combination. `forecasts`: per filter (the bank first) of all runs.
std::vector<LeftOutRow> left_out_rows(const std::vector<std::string>& filters,
                                      const std::vector<std::vector<HorizonEvaluation>>& forecasts);
/// The weights that left_out_rows found, in the form for ForecastTables. Empty if the rows lack a filter or a horizon.
std::vector<std::vector<double>> start_weights(const std::vector<LeftOutRow>& rows,
                                               const std::vector<Eigen::Index>& horizons,
                                               const std::vector<std::string>& filters);

/// Starting weights of `filters` (the bank first) at one horizon; empty if no row has the horizon.
std::vector<double> start_weights(const std::vector<CombinationRow>& rows, Eigen::Index horizon,
                                  const std::vector<std::string>& filters);

/// Rows for the forecasts of several filters and of their combination, added run by run.
class ForecastTables {
 public:
  /// The first filter is the bank. `start`: starting weights per horizon; if empty, they come from start_as_trained.
  ForecastTables(std::vector<std::string> filters, const std::vector<Trajectory>& runs,
                 std::vector<std::vector<double>> start = {});
  /// Adds every filter's predictions of the i-th run. Different runs may be added from different threads.
  void add(std::size_t run, const std::vector<HorizonEvaluation>& of_filters);
  /// Sets the starting weights of all runs added later, unless the caller gave weights. They are the most likely
  /// weights on the training runs so far (ForecastWeights::stacked); long runs are thinned evenly.
  void start_as_trained();
  const std::vector<std::vector<double>>& start() const { return start_; }

  /// Rows of all runs, filter by filter; those of combined_name follow if there are several filters.
  std::vector<HorizonRow> horizons() const;
  std::vector<CombinationRow> combination() const;

 private:
  std::vector<std::string> filters_;  ///< filters to combine
  const std::vector<Trajectory>& runs_;
  std::vector<std::vector<std::vector<HorizonSums>>> sums_;  ///< per filter and run; the combination is the last filter
  std::vector<Eigen::MatrixXd> weights_;                     ///< per run: filters x horizons, sums over its samples
  /// Per training run, horizon and filter: log densities of kept samples that the first filter scored.
  std::vector<std::vector<std::vector<std::vector<double>>>> densities_;
  Eigen::Index every_ = 1;                  ///< one of this many samples is kept in densities_
  std::vector<std::vector<double>> start_;  ///< per horizon; if empty, weights are equal
};

}  // namespace modebank
