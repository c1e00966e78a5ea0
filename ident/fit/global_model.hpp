#pragma once

#include <vector>

#include "ident/data/trajectory.hpp"
#include "ident/model/linear_model.hpp"
#include "ident/model/local_model.hpp"
#include "ident/model/motion_model.hpp"
#include "ident/model/transitions.hpp"

namespace modebank {

/// Ordinary least squares over all transitions of the training runs. Throws DataError without transitions.
/// Rank-deficient regressors give the minimum-norm solution.
GlobalModel fit_global(const Recording& recording, const LinearStructure& structure);

/// Least squares of one-step residuals over all training transitions, from the model's start values. Several states are
/// weighted by the standard deviations of their residuals (three passes). Throws DataError without transitions.
GlobalModel fit_global(const Recording& recording, const MotionModel& model);

/// Whether the training runs need a constant: leaving it out of this structure, fitted by least squares, loses at least
/// 6 nats of the Gaussian likelihood in all. (Where a pole is near 1, its t value does not follow a t distribution.)
bool needs_constant(const Recording& recording, LinearStructure structure);

/// Regressors whose coefficients the training runs do not determine, because they are always zero or linearly
/// dependent. Their parameters have NaN covariances in the model of fit_global; all other parameters keep their
/// covariances. Empty if there are no such regressors, or no transitions.
std::vector<Index> unidentifiable_regressors(const Recording& recording, const LinearStructure& structure);

/// The undetermined columns of a matrix of regressors, from its decomposition. These are the columns whose unit vectors
/// lie outside the row space, after all columns are scaled to unit norm.
std::vector<Index> unidentifiable_columns(const Eigen::MatrixXd& X, const Decomposition& d);

}  // namespace modebank
