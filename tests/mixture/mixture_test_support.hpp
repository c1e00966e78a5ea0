#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>

#include "mixture/em.hpp"
#include "mixture/gaussian_mixture.hpp"
#include "mixture/select.hpp"

namespace modebank::test {

inline const Eigen::VectorXd unweighted;

/// Three clusters of different shape in two features, at `distance` standard deviations from each other. They overlap
/// if `distance` is small.
inline GaussianMixture three_clusters(double distance) {
  GaussianMixture mixture;
  mixture.weights = Eigen::Vector3d(0.5, 0.3, 0.2);
  mixture.means = distance * (Eigen::MatrixXd(2, 3) << 0.0, 1.0, -0.5, 0.0, 0.5, 1.0).finished();
  mixture.covariances = {(Eigen::Matrix2d() << 1.0, 0.3, 0.3, 0.8).finished(),
                         (Eigen::Matrix2d() << 0.6, -0.2, -0.2, 0.9).finished(),
                         (Eigen::Matrix2d() << 0.5, 0.0, 0.0, 1.2).finished()};
  return mixture;
}

inline Eigen::MatrixXd draw(const GaussianMixture& mixture, Eigen::Index count, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  return sample(mixture, count, generator);
}

/// Options for exactly this number of iterations, whether EM converges or not.
inline EmOptions fixed_iterations(int iterations, CovarianceType type = CovarianceType::full) {
  EmOptions options;
  options.covariance = type;
  options.tolerance = -1.0;
  options.max_iterations = iterations;
  return options;
}

/// Whether every entry is finite, and the weights are at least 0 with the sum 1.
inline bool is_finite(const GaussianMixture& mixture) {
  bool finite = mixture.weights.allFinite() && mixture.means.allFinite();
  for (const Eigen::MatrixXd& covariance : mixture.covariances) finite = finite && covariance.allFinite();
  return finite && std::abs(mixture.weights.sum() + mixture.noise.weight - 1.0) < 1e-12 &&
         mixture.weights.minCoeff() >= 0.0;
}

/// A cloud of clustered windows in `runs` runs of equal length, in order. `fits` has the same windows.
inline FeatureCloud cloud_of(const Eigen::MatrixXd& points, Eigen::Index runs) {
  FeatureCloud cloud;
  for (Eigen::Index f = 0; f < points.rows(); ++f) cloud.names.emplace_back(1, static_cast<char>('a' + f));
  cloud.points = points;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    cloud.windows.push_back(i);
    cloud.runs.push_back(i * runs / points.cols());
  }
  return cloud;
}

inline WindowFits fits_of(const FeatureCloud& cloud, Eigen::Index length, Eigen::Index step) {
  WindowFits fits;
  fits.length = length;
  fits.step = step;
  for (const Eigen::Index run : cloud.runs) fits.windows.push_back({run, 0});
  return fits;
}

}  // namespace modebank::test
