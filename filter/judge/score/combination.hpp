#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "filter/judge/run/free_run.hpp"
#include "filter/judge/run/horizon.hpp"
#include "filter/step/combined_filter.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/data/trajectory.hpp"

/// The forecasts of the bank and of its competitors, weighted by how well each has predicted the run so far.
namespace modebank {

/// What several filters predicted of one run, combined with ForecastWeights, which start anew with every run. A
/// forecast has the weights of the sample it was made at: nothing later enters.
struct CombinedForecasts {
  HorizonEvaluation predictions;
  /// Per horizon F x N: weights of the filters in the forecast of a sample; NaN where nothing was scored.
  std::vector<Eigen::MatrixXd> weight;
};
/// `members`: one at least, of the same run and horizons. A sample is scored where the first of them is. `start`: per
/// horizon the weights that the run starts with; empty: equal ones. Throws std::invalid_argument otherwise.
CombinedForecasts combine_forecasts(const std::vector<const HorizonEvaluation*>& members,
                                    const std::vector<std::vector<double>>& start = {});

/// Free runs of one run, mixed by constant weights. A band is that of a mixture in which each member's part is a normal
/// distribution of its mean, as wide to either side as its own band: one member alone keeps its band.
FreeRun combine_free_runs(const std::vector<const FreeRun*>& members, const std::vector<double>& weights);

/// How much a filter counted, one row of /evaluation/combination.
struct CombinationRow {
  Role role = Role::train;
  Eigen::Index horizon = 1;  ///< samples ahead; 0: in free run
  std::string filter;
  double weight = 0.0;          ///< mean over the scored samples of all runs of the role
  double start = not_a_number;  ///< at the start of a held-out run, and of any later one
};

/// Scores of a filter on the training runs, each by a fit that was learned without it: names and weights are
/// chosen by. One row of /bank/left_out.
struct LeftOutRow {
  std::string filter;           ///< bank, a competitor or combined_name
  Eigen::Index horizon = 1;     ///< samples ahead
  Eigen::Index samples = 0;     ///< scored
  double log_score = 0.0;       ///< mean log predictive density [nats/sample]
  Eigen::VectorXd rmse;         ///< n_y [state unit]
  double start = not_a_number;  ///< weight at the start of a run in combined forecasts; NaN of combined_name
};
/// Rows of filters and, of two or more, of their combination. `forecasts`: of each filter, the bank first, the runs.
std::vector<LeftOutRow> left_out_rows(const std::vector<std::string>& filters,
                                      const std::vector<std::vector<HorizonEvaluation>>& forecasts);
/// The weights that left_out_rows found, as ForecastTables takes them; empty unless the rows have all filters and
/// horizons.
std::vector<std::vector<double>> start_weights(const std::vector<LeftOutRow>& rows,
                                               const std::vector<Eigen::Index>& horizons,
                                               const std::vector<std::string>& filters);

/// Which of `filters` (the bank first) at which horizon starts with which weight; empty where no row has the horizon.
/// Archives that hold no starts have mean weights.
std::vector<double> start_weights(const std::vector<CombinationRow>& rows, Eigen::Index horizon,
                                  const std::vector<std::string>& filters);

/// Samples that stacked weights are taken from, about: evenly spaced ones where there are more.
inline constexpr Eigen::Index enough_densities = 20000;
/// ForecastWeights::stacked of the log densities of runs, each filters x N; of some of the samples where they are many.
std::vector<double> stacked_weights(const std::vector<Eigen::MatrixXd>& log_densities);

/// Rows on the forecasts of several filters and on their combination, run by run: of what was predicted only sums stay,
/// and of training runs a part of the densities.
class ForecastTables {
 public:
  /// The first filter is the bank. `start`: per horizon weights that other forecasts have left, see combine_forecasts;
  /// empty: start_as_trained finds some.
  ForecastTables(std::vector<std::string> filters, const std::vector<Trajectory>& runs,
                 std::vector<std::vector<double>> start = {});
  /// What every filter predicted of the i-th run. Different runs may come from different threads.
  void add(std::size_t run, const std::vector<HorizonEvaluation>& of_filters);
  /// Runs that are added from now on start with the weights that make the training runs that are there most likely,
  /// unless weights were given.
  void start_as_trained();

  /// Of all runs: filter by filter, then, of two or more, combined_name.
  std::vector<HorizonRow> horizons() const;
  std::vector<CombinationRow> combination() const;

 private:
  /// Sums over samples: filters x horizons, and horizons.
  struct Weights {
    Eigen::MatrixXd sum;
    Eigen::VectorXd samples;
  };
  std::vector<std::string> filters_;  ///< that are combined
  const std::vector<Trajectory>& runs_;
  std::vector<std::vector<std::vector<HorizonSums>>> sums_;  ///< per filter, at last the combination, and run
  std::vector<Weights> weights_;                             ///< per run
  std::vector<std::vector<Eigen::MatrixXd>> densities_;      ///< per training run and horizon: filters x some samples
  Eigen::Index every_ = 1;                                   ///< of how many samples one is kept in densities_
  std::vector<std::vector<double>> start_;                   ///< per horizon; empty: equal weights

  Weights weights_of(Role role) const;
  bool combines() const { return filters_.size() > 1; }
  static Weights sum_weights(const std::vector<Eigen::MatrixXd>& weight);
};

}  // namespace modebank
