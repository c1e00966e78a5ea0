#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>

#include "mixture/gaussian_mixture.hpp"
#include "modebank/mixture/options.hpp"

namespace modebank {

/// A fitted mixture and how the fit ended.
struct EmResult {
  GaussianMixture mixture;      ///< ordered by decreasing weight; if the fit began at a given start, in the order of
                                ///< the start
  double log_likelihood = 0.0;  ///< log-likelihood: weighted sum over the points under `mixture`
  int iterations = 0;           ///< iterations of the restart that was kept
  bool converged = false;
  /// Number of restarts whose own optimum (before crossing) is within 1e-4 nats per point of the best log-likelihood. 0
  /// if only a crossing found the best.
  int agreeing_restarts = 0;
  bool floor_active = false;  ///< whether the covariance floor acted on any component in the last iteration
};

/// Throws std::invalid_argument for points that cannot be fitted: no points, sizes that do not fit, values, weights or
/// error covariances out of range.
void check_points(const PointSet& points);

/// Fits K components: the best of options.restarts restarts, improved by split-and-merge moves (Ueda et al. 2000) and
/// by crossing (restarts.hpp). Points must be finite, up to 1e150 in magnitude.
/// - Units: a feature is measured in units of its typical error or, if the error is unknown, of its standard deviation.
///   So the fit does not depend on the features' units. A constant feature keeps its unit. The floor limits the
///   variance of a constant feature, and of points at one place.
/// - The M step with the floor is the exact constrained maximiser, so the likelihood never falls. A component that
///   explains less than 1e-14 of the weight keeps its mean and covariance.
/// - Squared extrapolation (Varadhan & Roland 2008) reduces the iterations.
/// - Points with error covariances are deconvolved: the components describe the error-free points (Bovy, Hogg &
///   Roweis 2011, Ann. Appl. Stat. 5, eq. 16). With errors of zero the result does not change.
///
/// Throws std::invalid_argument for K < 1, K > N, invalid options, weights, points or error covariances. The result is
/// the same to the last bit for any number of threads.
EmResult fit_em(const PointSet& points, Eigen::Index components, const EmOptions& options, std::uint64_t seed);
/// fit_em for several numbers of components over the same points. The points are prepared once and must outlive this
/// object. Several threads may call fit(). Its result depends on its own arguments alone.
class EmSweep {
 public:
  EmSweep(const PointSet& points, const EmOptions& options);
  ~EmSweep();
  EmSweep(const EmSweep&) = delete;
  EmSweep& operator=(const EmSweep&) = delete;

  /// Fits `components`. If `start` is given (physical units, the same number of components), the first restart begins
  /// there. Throws the errors of fit_em.
  EmResult fit(Eigen::Index components, std::uint64_t seed, const GaussianMixture* start = nullptr) const;

 private:
  struct Prepared;
  std::unique_ptr<Prepared> prepared_;
};

/// Plain EM from a given start, without restarts. The components keep the start's order. The start's covariances are
/// raised to the floor, and reduced to their diagonals for CovarianceType::diagonal. If a noise component is requested
/// and the start has none, it begins with weight 0.05. Its box is always that of the points.
EmResult fit_em(const PointSet& points, const GaussianMixture& start, const EmOptions& options);

inline EmResult fit_em(const Eigen::MatrixXd& points, const Eigen::VectorXd& weights, Eigen::Index components,
                       const EmOptions& options, std::uint64_t seed) {
  return fit_em(PointSet(points, weights), components, options, seed);
}
inline EmResult fit_em(const Eigen::MatrixXd& points, const Eigen::VectorXd& weights, const GaussianMixture& start,
                       const EmOptions& options) {
  return fit_em(PointSet(points, weights), start, options);
}

}  // namespace modebank
