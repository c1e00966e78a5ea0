#include "mixture/noise_start.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace modebank {

using Eigen::Index;

GaussianMixture keep_densest(const GaussianMixture& mixture, Index components) {
  constexpr double least_noise = 0.01, most_noise = 0.5;
  std::vector<double> log_peak;
  for (Index k = 0; k < mixture.components(); ++k) {
    const double determinant = mixture.covariances[static_cast<std::size_t>(k)].determinant();
    log_peak.push_back(std::log(mixture.weights(k)) - 0.5 * std::log(determinant));
  }
  std::vector<Index> order(log_peak.size());
  std::iota(order.begin(), order.end(), Index{0});
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) {
    return log_peak[static_cast<std::size_t>(a)] > log_peak[static_cast<std::size_t>(b)];
  });
  order.resize(static_cast<std::size_t>(std::min(components, mixture.components())));
  std::sort(order.begin(), order.end());
  GaussianMixture kept;
  kept.type = mixture.type;
  kept.weights = mixture.weights(order);
  kept.means = mixture.means(Eigen::all, order);
  for (const Index k : order) kept.covariances.push_back(mixture.covariances[static_cast<std::size_t>(k)]);
  kept.noise.weight = std::clamp(1.0 - kept.weights.sum() / mixture.weights.sum(), least_noise, most_noise);
  return kept;
}

}  // namespace modebank
