#pragma once

#include <Eigen/Core>

#include "ident/fit/options.hpp"
#include "ident/lag/lagged_rows.hpp"

namespace modebank {

/// Forecasts of one structure, which was fitted without each fold in turn.
struct LeftOutForecast {
  Eigen::VectorXd of_part;  ///< sums of log densities over the rows of each part [nats]
  Eigen::VectorXd rmse;     ///< n [state unit]
  double log_score = 0.0;   ///< [nats/sample]
};

/// Cross-validation of structures on rows that all of them share. Forecasts are scored under a Student t whose scale
/// and degrees of freedom fit the structure's own errors, state by state.
class StructureScorer {
 public:
  /// Keeps the reference. `quantum` as in Recording.
  StructureScorer(const LaggedRows& rows, const Eigen::VectorXd& quantum);

  /// Least squares from Gram matrices that are shared by all structures. Regressors of deficient rank count for what
  /// they determine.
  LeftOutForecast least_squares(const LinearStructure& structure) const;
  /// The loss and the scale of window fits, each state on its own; least squares where such a fit fails.
  LeftOutForecast robust(const LinearStructure& structure, const FitOptions& options) const;

  /// Errors of least squares of the rows left out, N x n.
  Eigen::MatrixXd least_squares_errors(const LinearStructure& structure) const;
  /// Sample weights, or rows, of each part.
  const Eigen::VectorXd& part_weight() const { return part_weight_; }

 private:
  const LaggedRows& rows_;
  Eigen::VectorXd least_scale_;         ///< n
  Eigen::VectorXd part_weight_;         ///< parts
  std::vector<Eigen::MatrixXd> gram_;   ///< X'X without each fold
  std::vector<Eigen::MatrixXd> cross_;  ///< X'Y without each fold

  Eigen::MatrixXd robust_errors(const LinearStructure& structure, const FitOptions& options) const;
  LeftOutForecast forecast(const Eigen::MatrixXd& errors) const;
};

}  // namespace modebank
