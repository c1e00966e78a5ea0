#pragma once

#include "ident/data/trajectory.hpp"

namespace modebank {

/// One column that the others give in every sample up to rounding: column[k] = sum of terms + constant. Columns are
/// counted from 0: n states, then m inputs.
struct ColumnRelation {
  struct Term {
    Index column, lag;  ///< lag: number of samples before the explained one
    double coefficient;
  };
  Index column = 0;
  std::vector<Term> terms = {};  ///< largest effect first: all if `complete`, else the 4 largest over 20 lags
  double constant = 0.0;         ///< 0 where rounding explains it
  bool complete = false;
  std::vector<Index> joined = {};  ///< the other columns in it, increasing
  bool follows_states = false;     ///< an input given by states and the constant alone: the set point has to move
};

/// Columns that the training runs cannot tell apart, with any model. `quanta` (n + m) are the steps of the columns'
/// decimals; 0: unknown. A column that only its own past gives is smooth and not reported.
struct Identifiability {
  std::vector<ColumnRelation> relations;
  std::vector<Index> resting;  ///< columns that never move
};
Identifiability identifiable(const Recording& recording, const Eigen::VectorXd& quanta);

/// Steps of the decimals of each column (n + m) over the training runs: 0.01 for 20.13; 0 where 12 decimals are too
/// few.
Eigen::VectorXd decimal_steps(const Recording& recording);

}  // namespace modebank
