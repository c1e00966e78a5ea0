#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "filter/judge/run/free_run.hpp"
#include "filter/judge/run/horizon.hpp"
#include "filter/step/combined_filter.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/data/trajectory.hpp"

/// Combination of the forecasts of the bank and its competitors, weighted by past success within the run.
namespace modebank {

/// Forecasts of several filters for one run, combined by ForecastWeights, which restart with every run. A forecast has
/// the weights of its origin, so no later information enters.
struct CombinedForecasts {
  HorizonEvaluation predictions;
  /// Per horizon F x N: the filters' weights in the forecast of a sample; NaN where nothing was scored.
  std::vector<Eigen::MatrixXd> weight;
};
/// Combines forecasts. `members`: at least one, of the same run and horizons. A sample is scored if the first member
/// scores it. `start`: per horizon the starting weights; empty: equal. Throws std::invalid_argument otherwise.
CombinedForecasts combine_forecasts(const std::vector<const HorizonEvaluation*>& members,
                                    const std::vector<std::vector<double>>& start = {});

/// Combines free runs of one run with constant weights. In the band of the mixture each member is a normal distribution
/// about its mean, on each side as wide as its own band. So a single member keeps its band.
FreeRun combine_free_runs(const std::vector<const FreeRun*>& members, const std::vector<double>& weights);

/// Mean weight of a filter; one row of /evaluation/combination.
struct CombinationRow {
  Role role = Role::train;
  Eigen::Index horizon = 1;  ///< samples ahead; 0: free run
  std::string filter;
  double weight = 0.0;          ///< mean over the scored samples of all runs of the role
  double start = not_a_number;  ///< weight at the start of a held-out or later run
};

/// Scores of a filter on the training runs, each by a fit learned without that run. Names and weights are chosen by
/// them. One row of /bank/left_out.
struct LeftOutRow {
  std::string filter;           ///< bank, a competitor or combined_name
  Eigen::Index horizon = 1;     ///< samples ahead
  Eigen::Index samples = 0;     ///< scored samples
  double log_score = 0.0;       ///< mean log predictive density [nats/sample]
  Eigen::VectorXd rmse;         ///< n_y [state unit]
  double start = not_a_number;  ///< starting weight in combined forecasts; NaN for combined_name
};
/// Rows of the filters and, for two or more, of their combination. `forecasts`: per filter (the bank first) the
/// forecasts of all runs.
std::vector<LeftOutRow> left_out_rows(const std::vector<std::string>& filters,
                                      const std::vector<std::vector<HorizonEvaluation>>& forecasts);
/// The weights found by left_out_rows, in the form that ForecastTables expects; empty unless the rows have all filters
/// and horizons.
std::vector<std::vector<double>> start_weights(const std::vector<LeftOutRow>& rows,
                                               const std::vector<Eigen::Index>& horizons,
                                               const std::vector<std::string>& filters);

/// Starting weights of `filters` (the bank first) at one horizon; empty if no row has the horizon. Archives without
/// starting weights give mean weights.
std::vector<double> start_weights(const std::vector<CombinationRow>& rows, Eigen::Index horizon,
                                  const std::vector<std::string>& filters);

/// About how many samples stacked weights are computed from; more are thinned evenly.
inline constexpr Eigen::Index enough_densities = 20000;
/// ForecastWeights::stacked of the log densities of runs (filters x N each); large sets are thinned.
std::vector<double> stacked_weights(const std::vector<Eigen::MatrixXd>& log_densities);

/// Rows for the forecasts of several filters and of their combination, run by run. It keeps sums, and for training runs
/// some densities.
class ForecastTables {
 public:
  /// The first filter is the bank. `start`: per horizon starting weights from earlier forecasts, see combine_forecasts;
  /// empty: from start_as_trained.
  ForecastTables(std::vector<std::string> filters, const std::vector<Trajectory>& runs,
                 std::vector<std::vector<double>> start = {});
  /// Adds every filter's predictions of the i-th run. Different runs may be added from different threads.
  void add(std::size_t run, const std::vector<HorizonEvaluation>& of_filters);
  /// Sets the starting weights of all runs added later to those that are most likely on the training runs so far,
  /// unless weights were given.
  void start_as_trained();

  /// Rows of all runs: filter by filter, then, for two or more, combined_name.
  std::vector<HorizonRow> horizons() const;
  std::vector<CombinationRow> combination() const;

 private:
  /// Sums over samples: filters x horizons, and horizons.
  struct Weights {
    Eigen::MatrixXd sum;
    Eigen::VectorXd samples;
  };
  std::vector<std::string> filters_;  ///< filters to combine
  const std::vector<Trajectory>& runs_;
  std::vector<std::vector<std::vector<HorizonSums>>> sums_;  ///< per filter (the combination last) and run
  std::vector<Weights> weights_;                             ///< per run
  std::vector<std::vector<Eigen::MatrixXd>> densities_;      ///< per training run and horizon: filters x some samples
  Eigen::Index every_ = 1;                                   ///< one in this many samples is kept in densities_
  std::vector<std::vector<double>> start_;                   ///< per horizon; empty: equal weights

  Weights weights_of(Role role) const;
  bool combines() const { return filters_.size() > 1; }
  static Weights sum_weights(const std::vector<Eigen::MatrixXd>& weight);
};

}  // namespace modebank
