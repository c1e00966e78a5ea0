#pragma once

#include <vector>

#include "ident/data/trajectory.hpp"
#include "ident/model/linear_model.hpp"
#include "ident/model/transitions.hpp"

namespace modebank {

/// Regressors whose coefficients the training runs do not determine, because they are always zero or linearly
/// dependent. Their parameters have NaN covariances in the model of fit_global; all other parameters keep their
/// covariances. Empty if there are no such regressors, or no transitions.
std::vector<Index> unidentifiable_regressors(const Recording& recording, const LinearStructure& structure);

/// The undetermined columns of a matrix of regressors, from its decomposition. These are the columns whose unit vectors
/// lie outside the row space, after all columns are scaled to unit norm.
std::vector<Index> unidentifiable_columns(const Eigen::MatrixXd& X, const Decomposition& d);

}  // namespace modebank
