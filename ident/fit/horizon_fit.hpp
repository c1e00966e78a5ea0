#pragma once

#include <Eigen/Core>

#include "ident/data/trajectory.hpp"
#include "ident/model/linear_model.hpp"

namespace modebank {

/// Errors of the predictions of samples origin + 1 to origin + horizon of a run, n x horizon. The model knows the
/// samples up to `origin`, at least the structure's first transition, and all inputs. NaN for missing measurements and
/// beyond the run's end.
Eigen::MatrixXd errors_ahead(const LinearStructure& structure, const Eigen::VectorXd& theta, const Trajectory& run,
                             Index origin, Index horizon);

/// theta that minimises the squared errors of predictions 1 to `horizon` samples ahead in the training runs, near
/// `start` (simulation error: Farina & Piroddi 2010, International Journal of Control 83(7)). States are weighted by
/// their root mean squares at the start. Predictions from neighbouring origins are nearly the same, so one origin in
/// horizon / 4 samples (rounded up) is used; origins with missing samples are left out. `start` itself without any
/// origin or where the search fails. The errors of neighbouring origins are correlated: theta has no standard errors.
Eigen::VectorXd fit_over_horizon(const Recording& recording, const LinearStructure& structure,
                                 const Eigen::VectorXd& start, Index horizon);

}  // namespace modebank
