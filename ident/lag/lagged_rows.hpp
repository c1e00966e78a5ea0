#pragma once

#include <Eigen/Core>
#include <vector>

#include "ident/data/trajectory.hpp"
#include "ident/model/transitions.hpp"

namespace modebank {

/// Numbers of lags, from low to high.
struct LagRange {
  Index low = 1, high = 1;
  bool holds(Index value) const { return value >= low && value <= high; }
};

/// The structures of a search: every combination that needs no more samples than `memory` before its first prediction.
struct StructureRanges {
  LagRange state_lags, input_lags, input_delay;
  Index memory = 1000;
  bool holds(Index state, Index input, Index delay) const {
    return state_lags.holds(state) && input_lags.holds(input) && input_delay.holds(delay) && state <= memory &&
           input + delay <= memory + 1;
  }
};

/// Transitions of the training runs, the same for all structures of some ranges: those whose regressors are all
/// measured in the same run even with the most lags. Rows stand fold by fold.
///
/// Columns of X span those of the widest structure, and their leading parts those of narrower ones: the newest state,
/// differences between successive older ones (which keep their digits where a signal is smooth), inputs from the least
/// delay on, and a constant one. They are of unit root mean square, and of zero mean where there is a constant.
struct LaggedRows {
  Index states = 1, inputs = 0;
  StructureRanges ranges;
  bool intercept = false;
  Eigen::MatrixXd X;              ///< N x q
  Eigen::MatrixXd Y;              ///< N x n, increments
  Eigen::VectorXd weight;         ///< N sample weights of mean one, or empty: all one
  std::vector<Index> part;        ///< N, position of the run, or of the stretch of a run, that a row is of
  std::vector<Index> fold_begin;  ///< folds + 1 positions of rows
  Index parts = 0;
  bool by_runs = false;  ///< parts are whole runs
  double share = 0.0;    ///< of the rows that one lag would leave

  Index count() const { return X.rows(); }
  Index folds() const { return static_cast<Index>(fold_begin.size()) - 1; }
  double weight_of(Index row) const { return weight.size() > 0 ? weight(row) : 1.0; }
  /// Columns of one structure.
  std::vector<Index> columns(const LinearStructure& structure) const;
};

/// At least six runs are parts; fewer are cut into stretches, ten or more together. Parts are dealt to five folds. Of
/// long recordings evenly spaced stretches of rows are taken, so that X has about four million entries at most.
LaggedRows make_lagged_rows(const Recording& recording, const StructureRanges& ranges, bool intercept);

}  // namespace modebank
