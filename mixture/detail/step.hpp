#pragma once

#include <Eigen/Core>

#include "mixture/detail/cloud.hpp"
#include "mixture/gaussian_mixture.hpp"

namespace modebank {

/// What one pass over the points yields: all an M step needs, without any N x K array.
struct MixtureMoments {
  double log_likelihood = 0.0;  ///< sum of w_i log p(x_i) under the mixture the pass was made with
  double noise = 0.0;           ///< sum of r of the noise component
  /// One column per component; rows: sum of r, sum of r d (F), sum of r d d' (lower triangle by rows, or its diagonal),
  /// with r = w_i times the responsibility and d the point's offset from the component's *old* mean, so that no second
  /// moment is a difference of large numbers.
  Eigen::MatrixXd sums;
};

/// E step. Blocks are summed in fixed groups and groups in order, in parallel when there are many points: the result
/// does not depend on the number of threads. `background` (block_size x blocks, aligned), where given, is the log
/// density of what else there is at every point, in place of the mixture's noise component.
MixtureMoments expect(const PointBlocks& points, const GaussianMixture& mixture, const double* background = nullptr);

/// The same without sums of components: log-likelihood and noise, the same to the last bit.
MixtureMoments measure(const PointBlocks& points, const GaussianMixture& mixture);

/// M step in place. Covariance eigenvalues (diagonal: variances) below `floor` are raised to it, which is the exact
/// maximiser under that constraint, so the likelihood never falls. A component that explains less than 1e-14 of the
/// total weight keeps its mean and covariance. Returns whether the floor held any component.
bool maximise(const MixtureMoments& moments, double floor, GaussianMixture& mixture);

}  // namespace modebank
