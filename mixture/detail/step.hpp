#pragma once

#include <Eigen/Core>

#include "mixture/detail/cloud.hpp"
#include "mixture/gaussian_mixture.hpp"

namespace modebank {

/// Result of one pass over the points: all sums that an M step needs, without an N x K array.
struct MixtureMoments {
  double log_likelihood = 0.0;  ///< sum of w_i log p(x_i) under the mixture of the pass
  double noise = 0.0;           ///< sum of r for the noise component

  /// One column per component. Its rows are: sum of r, sum of r d (F), sum of r d d' (lower triangle by rows, or its
  /// diagonal). r is w_i times the responsibility. d is the point's offset from the component's *old* mean, so that no
  /// second moment is a difference of large numbers.
  Eigen::MatrixXd sums;
};

/// E step. Blocks are summed in fixed groups, and the groups are added in order. So the result does not depend on the
/// number of threads. Runs in parallel for many points. `background` (block_size x blocks, aligned, may be null)
/// replaces the noise component: a log density at every point.
MixtureMoments expect(const PointBlocks& points, const GaussianMixture& mixture, const double* background = nullptr);

/// `expect` without the components' sums. Log-likelihood and noise equal those of `expect` to the last bit.
MixtureMoments measure(const PointBlocks& points, const GaussianMixture& mixture);

/// M step in place. Eigenvalues of covariances (for diagonal ones, variances) are raised to at least `floor`. The
/// result is the exact maximiser under this constraint, so the likelihood never falls. A component that explains less
/// than 1e-14 of the total weight keeps its mean and covariance. Returns whether the floor acted on any component.
bool maximise(const MixtureMoments& moments, double floor, GaussianMixture& mixture);

}  // namespace modebank
