#pragma once

#include <Eigen/Core>

#include "ident/fit/options.hpp"
#include "ident/lag/lagged_rows.hpp"

namespace modebank {

/// Forecasts of one structure. Each fold is predicted by a fit without this fold.
struct LeftOutForecast {
  Eigen::VectorXd of_part;  ///< sum of log densities over each part's rows [nats]
  Eigen::VectorXd rmse;     ///< n, RMSE of the one-step prediction [state unit]
  double log_score = 0.0;   ///< [nats/sample]
};

/// Number of rows of each part.
Eigen::VectorXd part_rows_of(const StretchParts& parts);

/// Forecasts whose errors (N x n) are `errors`, scored under a Student t distribution, whose scale and degrees of
/// freedom are fitted to the errors, separately for each state. `least_scale` (n): smallest scale.
LeftOutForecast left_out_forecast(const Eigen::MatrixXd& errors, const StretchParts& parts,
                                  const Eigen::VectorXd& least_scale);

/// Cross-validation of structures on the same rows.
class StructureScorer {
 public:
  /// Holds a reference to `rows`, which must outlive this object. `quantum`: as in Recording.
  StructureScorer(const LaggedRows& rows, const Eigen::VectorXd& quantum);

  /// Scores least squares, computed from Gram matrices that all structures share. If regressors are rank deficient, the
  /// solution has minimum norm.
  LeftOutForecast least_squares(const LinearStructure& structure) const;
  /// Scores fits with the loss and scale of the windows, separately for each state. Least squares is used if such a fit
  /// fails.
  LeftOutForecast robust(const LinearStructure& structure, const FitOptions& options) const;

  /// Least-squares errors of the left-out rows, N x n.
  Eigen::MatrixXd least_squares_errors(const LinearStructure& structure) const;
  /// Number of rows of each part.
  const Eigen::VectorXd& part_rows() const { return part_rows_; }

 private:
  const LaggedRows& rows_;
  Eigen::VectorXd least_scale_;         ///< n
  Eigen::VectorXd part_rows_;           ///< parts
  std::vector<Eigen::MatrixXd> gram_;   ///< X'X of the rows outside each fold
  std::vector<Eigen::MatrixXd> cross_;  ///< X'Y of the rows outside each fold

  Eigen::MatrixXd robust_errors(const LinearStructure& structure, const FitOptions& options) const;
  LeftOutForecast forecast(const Eigen::MatrixXd& errors) const;
};

}  // namespace modebank
