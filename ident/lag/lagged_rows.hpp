#pragma once

#include <Eigen/Core>
#include <vector>

#include "ident/data/trajectory.hpp"
#include "ident/model/transitions.hpp"

namespace modebank {

/// Parts of the data that are left out together. They are whole runs, or stretches of runs if there are few runs.
struct StretchParts {
  std::vector<Index> part;  ///< N, index of each row's part
  Index count = 0;
  bool by_runs = false;  ///< true: the parts are whole runs; false: stretches of runs
};

/// Divides rows into parts. With `fewest_runs` or more, the parts are the runs. Fewer runs are cut into at least
/// `fewest_parts` stretches with about equal numbers of rows. `run`: N, index of each row's run, below `runs`.
StretchParts stretch_parts(const std::vector<Index>& run, Index runs, Index fewest_runs = 6, Index fewest_parts = 10);

/// An inclusive range of numbers of lags.
struct LagRange {
  Index low = 1, high = 1;
  bool holds(Index value) const { return value >= low && value <= high; }
};

/// The structures of a search: every combination of lags that needs at most `memory` samples before its first
/// prediction.
struct StructureRanges {
  LagRange state_lags, input_lags, input_delay;
  Index memory = 1000;
  InputDelays newest = 1;  ///< ages of the newest inputs of the rows; the latest is input_delay.low
  bool holds(Index state, Index input, Index delay) const {
    return state_lags.holds(state) && input_lags.holds(input) && input_delay.holds(delay) && state <= memory &&
           input + delay <= memory + 1;
  }
};

/// The transitions of the training runs that every structure in some ranges can predict. Even with the largest lags,
/// the regressors of these transitions were measured in the same run. Rows are ordered by fold.
///
/// X has the columns of the structure with the largest lags. Other structures use the leading columns of each kind. The
/// columns are the newest state, differences between successive older states (accurate for smooth signals), inputs from
/// the smallest delay on, and a constant. Columns have unit root mean square, and zero mean if there is a constant.
struct LaggedRows {
  Index states = 1, inputs = 0;
  StructureRanges ranges;
  bool intercept = false;
  Eigen::MatrixXd X;              ///< N x q, regressors
  Eigen::MatrixXd Y;              ///< N x n, increments
  std::vector<Index> fold_begin;  ///< folds + 1, first row of each fold
  StretchParts parts;             ///< of the rows
  double share = 0.0;             ///< number of rows of X, as a share of the rows that a one-lag model could use

  Index count() const { return X.rows(); }
  Index folds() const { return static_cast<Index>(fold_begin.size()) - 1; }
  /// The columns of X that one structure uses.
  std::vector<Index> columns(const LinearStructure& structure) const;
};

/// Makes the rows and distributes their parts over five folds. With six or more runs, the parts are the runs. Fewer
/// than six runs are cut into at least ten stretches. Long recordings are thinned to evenly spaced stretches, so that X
/// has at most about four million entries.
LaggedRows make_lagged_rows(const Recording& recording, const StructureRanges& ranges, bool intercept);

}  // namespace modebank
