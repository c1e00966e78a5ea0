#pragma once

#include <Eigen/Core>

#include "ident/fit/prior.hpp"
#include "ident/model/transitions.hpp"

namespace modebank {

/// Row-major, so that the rows of one sample are contiguous.
using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// A window's fit in whitened form: theta = origin + basis z, with residuals r(z) = b - J z in units of sigma (or of
/// the prior's sd). Rows k n .. k n + n - 1 belong to sample k and share one loss. The rows after the samples belong to
/// the prior and have quadratic loss. J has orthonormal columns, and z = 0 is the least-squares solution (J'b = 0), in
/// any units of the data.
struct WhitenedProblem {
  Index samples = 0;  ///< L
  Index states = 0;   ///< n
  RowMajorMatrix J;
  Eigen::VectorXd b;
  Eigen::MatrixXd basis;   ///< p rows, one column per unknown z
  Eigen::VectorXd origin;  ///< p, least-squares theta

  Index unknowns() const { return J.cols(); }
  Index sample_rows() const { return samples * states; }
  Index prior_rows() const { return J.rows() - sample_rows(); }
  Eigen::VectorXd theta(const Eigen::VectorXd& z) const { return origin + basis * z; }
};

/// Whitens a window's problem. Without a prior, z spans the excited directions of `decomposition` (of the regressors)
/// and theta has minimum norm. With a prior, z spans all of theta. `sigma`: n positive entries; `prior` may be null.
WhitenedProblem whiten(const Transitions& transitions, const Decomposition& decomposition, const Eigen::VectorXd& sigma,
                       const ParameterPrior* prior);

}  // namespace modebank
