#pragma once

#include <vector>

#include "ident/data/trajectory.hpp"
#include "ident/model/linear_model.hpp"
#include "ident/model/transitions.hpp"

namespace modebank {

/// Which regressors' coefficients the training runs leave open: those that are always zero, and those of which sums
/// are. Their parameters have covariances of NaN in fit_global's model, all others keep theirs. Empty: none, or there
/// is no transition.
std::vector<Index> open_regressors(const Recording& recording, const LinearStructure& structure);

/// The same of a matrix of regressors and its decomposition: the columns whose coefficients no row sees alone. With
/// columns scaled to unit norm, their unit vectors lie outside the row space.
std::vector<Index> open_columns(const Eigen::MatrixXd& X, const Decomposition& d);

}  // namespace modebank
