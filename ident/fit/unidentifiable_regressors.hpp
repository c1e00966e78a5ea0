#pragma once

#include <vector>

#include "ident/data/trajectory.hpp"
#include "ident/model/linear_model.hpp"
#include "ident/model/transitions.hpp"

namespace modebank {

/// Regressors whose coefficients the training runs do not determine: they are always zero, or linearly dependent. Their
/// parameters have NaN covariances in fit_global's model; all other parameters keep their covariances. Empty if there
/// are no such regressors, or no transitions.
std::vector<Index> unidentifiable_regressors(const Recording& recording, const LinearStructure& structure);

/// The undetermined columns of a matrix of regressors, from its decomposition. With columns scaled to unit norm, the
/// unit vectors of these columns lie outside the row space.
std::vector<Index> unidentifiable_columns(const Eigen::MatrixXd& X, const Decomposition& d);

}  // namespace modebank
