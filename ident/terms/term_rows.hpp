#pragma once

#include <Eigen/Core>
#include <vector>

#include "ident/data/trajectory.hpp"
#include "ident/model/linear_model.hpp"

namespace modebank {

/// Transitions of the training runs that terms are looked for in, the same for all structures up to the widest: those
/// whose regressors are all measured even with the most lags.
struct TermRows {
  LinearStructure widest;
  Eigen::MatrixXd X;               ///< N x q regressors of the widest structure
  Eigen::MatrixXd Y;               ///< N x n increments
  std::vector<Eigen::Index> part;  ///< N, position of the run, or of the stretch of a run, that a row is of
  Eigen::Index parts = 0;

  Eigen::Index count() const { return X.rows(); }
  /// Regressors of a structure with the same delay and no more lags.
  Eigen::MatrixXd regressors(const LinearStructure& structure) const;
  /// The rows of some parts, whose positions are counted anew; fewer than six are cut into stretches.
  TermRows some(const std::vector<bool>& of_part) const;
};

/// At least six runs are parts; fewer are cut into stretches, ten or more together. Of long recordings evenly spaced
/// stretches of rows are taken, `most_rows` at most or a few more. Sample weights do not count.
TermRows gather_term_rows(const Recording& recording, const LinearStructure& widest, Eigen::Index most_rows);

/// Mean over rows of a difference of log densities, and its standard error over parts.
struct PartGain {
  double mean = 0.0, standard_error = 0.0;  ///< [nats/sample]
};
PartGain gain_over_parts(const Eigen::VectorXd& difference, const TermRows& rows);

}  // namespace modebank
