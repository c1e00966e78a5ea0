#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "filter/judge/horizon.hpp"
#include "ident/data/trajectory.hpp"

/// The forecasts of the bank and of its competitors, weighted by how well each has predicted the run so far.
namespace modebank {

/// The filter that the combination is in rows; it is scored ahead and competes with nobody.
inline constexpr const char* combined_name = "combined";

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

/// How much a filter counted, one row of /evaluation/combination.
struct CombinationRow {
  Role role = Role::train;
  Eigen::Index horizon = 1;  ///< samples ahead
  std::string filter;
  double weight = 0.0;  ///< mean over the scored samples of all runs of the role
};

/// Rows on the forecasts of several filters and on their combination, run by run: of what was predicted only sums stay.
class ForecastTables {
 public:
  /// The first filter is the bank.
  ForecastTables(std::vector<std::string> filters, const std::vector<Trajectory>& runs);
  /// What every filter predicted of the i-th run. Different runs may come from different threads.
  void add(std::size_t run, const std::vector<HorizonEvaluation>& of_filters);
  /// Runs that are added from now on start with the mean weights of the training runs that are there.
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
  std::vector<std::vector<double>> start_;                   ///< per horizon; empty: equal weights

  Weights weights_of(Role role) const;
  bool combines() const { return filters_.size() > 1; }
  static Weights sum_weights(const std::vector<Eigen::MatrixXd>& weight);
};

}  // namespace modebank
