#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>

#include "mixture/gaussian_mixture.hpp"
#include "modebank/mixture/options.hpp"

namespace modebank {

/// A fitted mixture and how the fit ended.
struct EmResult {
  GaussianMixture mixture;      ///< by decreasing weight; in the start's order when fitted from a start
  double log_likelihood = 0.0;  ///< weighted sum over points, of `mixture`
  int iterations = 0;           ///< of the kept restart
  bool converged = false;
  /// Restarts that came within 1e-4 nats per point of the best log-likelihood by themselves, before they were crossed
  /// with the best one; 0: only crossing found it.
  int agreeing_restarts = 0;
  bool floor_active = false;  ///< whether the covariance floor held any component in the last iteration
};

/// Throws std::invalid_argument for points, weights or error covariances that nothing can be fitted to: none, sizes
/// that do not fit, values out of range.
void check_points(const PointSet& points);

/// Best of options.restarts runs, improved by split-and-merge moves (Ueda et al. 2000) and by crossing (restarts.hpp).
/// Points finite, up to 1e150 in magnitude. Fitted in units of each feature's typical error or else
/// standard deviation, so invariant to its units; a constant feature keeps its unit and is held by the floor, as are
/// coinciding points. The floored M step is the exact constrained maximiser, so the likelihood never falls; squared
/// extrapolation (Varadhan & Roland 2008) shortens the way. A component that explains less than 1e-14 of the weight
/// keeps its mean and covariance. Points with error covariances are deconvolved: the components describe the points
/// without their errors (Bovy, Hogg & Roweis 2011, Ann. Appl. Stat. 5, eq. 16); zero errors change nothing. Throws
/// std::invalid_argument for K < 1, K > N, bad options, weights, points or error covariances. Bitwise the same for any
/// number of threads.
EmResult fit_em(const PointSet& points, Eigen::Index components, const EmOptions& options, std::uint64_t seed);
/// fit_em for several numbers of components over the same points, which are prepared once and must outlive this. fit()
/// may be called from several threads; what it returns depends on its own arguments alone.
class EmSweep {
 public:
  EmSweep(const PointSet& points, const EmOptions& options);
  ~EmSweep();
  EmSweep(const EmSweep&) = delete;
  EmSweep& operator=(const EmSweep&) = delete;

  /// With `start` (physical units, of as many components) the first restart begins there. Throws like fit_em.
  EmResult fit(Eigen::Index components, std::uint64_t seed, const GaussianMixture* start = nullptr) const;

 private:
  struct Prepared;
  std::unique_ptr<Prepared> prepared_;
};

/// From a given start by plain EM, no restarts: the components keep the start's order; its covariances are raised to
/// the floor, and reduced to their diagonals for CovarianceType::diagonal. A noise component wanted but missing in the
/// start begins with a weight of 0.05; its box is always that of the points.
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
