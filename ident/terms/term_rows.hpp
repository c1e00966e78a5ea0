#pragma once

#include <Eigen/Core>
#include <vector>

#include "ident/data/trajectory.hpp"
#include "ident/model/linear_model.hpp"

namespace modebank {

/// Transitions of the training runs for the search for terms. All structures use the same transitions. Even with the
/// most lags, the regressors of these transitions were measured.
struct TermRows {
  LinearStructure widest;
  Eigen::MatrixXd X;               ///< N x q regressors of the structure with the most lags
  Eigen::MatrixXd Y;               ///< N x n increments
  std::vector<Eigen::Index> part;  ///< N, index of the row's run or stretch of a run
  Eigen::Index parts = 0;

  Eigen::Index count() const { return X.rows(); }
  /// Regressors of a structure with the same delay and at most the same numbers of lags.
  Eigen::MatrixXd regressors(const LinearStructure& structure) const;
  /// The rows of some parts, with new part numbers. Fewer than six parts are cut into stretches.
  TermRows some(const std::vector<bool>& of_part) const;
};

/// Collects the rows. With six or more runs, the parts are the runs. Fewer than six runs are cut into at least ten
/// stretches. Long recordings are thinned to evenly spaced stretches of about `most_rows` rows in total.
TermRows gather_term_rows(const Recording& recording, const LinearStructure& widest, Eigen::Index most_rows);

/// Mean difference of log densities over rows, and its standard error over parts.
struct PartGain {
  double mean = 0.0, standard_error = 0.0;  ///< [nats/sample]
};
PartGain gain_over_parts(const Eigen::VectorXd& difference, const TermRows& rows);

}  // namespace modebank
